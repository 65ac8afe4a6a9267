#pragma once
/// Whether this machine's SUNDIALS computes as another one's. What Brink itself computes has the same bits everywhere.

#include <string>

namespace brink {

/// 16 hexadecimal digits: a hash over what the steps of SUNDIALS depend on: its version, powers of the C library, and the
/// processor (where it has fused products, the library was compiled with them). Where it is the same, answers that need
/// a solver are the same to the last bit, too; elsewhere these alone may go another way.
std::string solver_probe();

}  // namespace brink
