#pragma once
/// Rows of a benchmark, printed and written.

#include <filesystem>
#include <vector>

#include "brink/scenes/bench/run.h"

namespace brink::bench {

/// True if the run came to its end, where it had to, and repeats gave the same bits.
bool is_good(const Row& row);

void print_heading(const Problem& problem);
void print(const Row& row);
/// @throws IoError
void write_csv(const std::filesystem::path& file, const std::vector<Row>& rows);

}  // namespace brink::bench
