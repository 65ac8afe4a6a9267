8                        // number of samples: three an edge
10  0 2.4  1.5 0  30 20  // mass  x y  vx vy  rotation in degrees  omega in rad/s
-0.5 -0.5
 0.0 -0.5
 0.5 -0.5
 0.5  0.0
 0.5  0.5
 0.0  0.5
-0.5  0.5
-0.5  0.0
