#include "brink/scenes/files/text_file.h"

#include <fstream>

#include "brink/core/base/error.h"

namespace brink {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLargestFile = 100'000'000;  // bytes; beyond, it is some other kind of file
// A block is as much as a pipe of Linux holds by default.
constexpr std::size_t kBlock = 1 << 16;

}  // namespace

std::string text_of_file(const fs::path& file) {
  std::error_code error;
  // On Linux a folder opens for reading as a file does, and only the read fails, without saying why.
  if (fs::is_directory(file, error)) throw IoError(file.string() + ": is a directory, not a file to read");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw IoError(file.string() + ": cannot be opened for reading");
  std::string text;
  // Block by block rather than by the file's size, which a pipe does not have. One byte beyond the limit
  // is enough to know that the file is too large.
  while (in && text.size() <= kLargestFile) {
    const std::size_t before = text.size();
    text.resize(before + kBlock);
    in.read(text.data() + before, static_cast<std::streamsize>(kBlock));
    text.resize(before + static_cast<std::size_t>(in.gcount()));
  }
  // The last, short block leaves eof and fail set, which is the normal end; bad is an error of the device.
  if (in.bad()) throw IoError(file.string() + ": could not be read");
  if (text.size() > kLargestFile) throw IoError(file.string() + ": is larger than the 1e8 bytes allowed");
  return text;
}

}  // namespace brink
