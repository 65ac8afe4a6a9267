#pragma once
/// `brink bench classic`: the classic detector against exact answers, and what each of its options costs.

#include <filesystem>

namespace brink::bench {

/// Sweeps sampling spacing x resolution x step x primitives x read-back on the problems with known answers
/// (shortened), the exact detectors beside; prints a table and writes classic.csv and classic.png. Then three
/// tables, printed and written: missed contacts against spacing and wedge angle (classic_missed.csv, .png),
/// orders of convergence (classic_orders.csv), and the time of every performance option against none
/// (classic_options.csv). False if an exact run ended early.
bool run_classic(const std::filesystem::path& folder);

/// The three tables after the sweep, one by one.
void measure_missed(const std::filesystem::path& folder);
void measure_orders(const std::filesystem::path& folder);
void measure_options(const std::filesystem::path& folder);

}  // namespace brink::bench
