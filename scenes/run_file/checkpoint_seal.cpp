#include "brink/scenes/run_file/checkpoint_seal.h"

#include <algorithm>
#include <cstring>

#include "brink/core/base/error.h"
#include "brink/core/base/hash.h"

namespace brink {
namespace {

// Copied byte by byte, so its layout is that of the file: no padding, as the assertion says.
// Initial values are those of a sound header, with which unsealed() compares.
struct Header {
  char magic[8] = {'B', 'R', 'I', 'N', 'K', 'C', 'P', '\n'};
  std::uint32_t version = 3, unused = 0;
  std::uint64_t length = 0, checksum = 0;
};
static_assert(sizeof(Header) == 32);

/// Over everything that a resume goes by, in a fixed order: another order would be another layout, and
/// needs another version in the header. Cost: proportional to the snapshot.
std::uint64_t seal_of(const ResumePoint& row, std::span<const std::byte> snapshot, std::uint64_t identity) {
  StateHash hash;
  hash.add(identity);
  hash.add(row.t);
  hash.add(row.wall_seconds);
  hash.add(static_cast<std::uint64_t>(row.frames));
  hash.add(static_cast<std::uint64_t>(row.events));
  hash.add(static_cast<std::uint64_t>(row.contacts));
  hash.add(static_cast<std::uint64_t>(row.knots));
  hash.add(checksum(snapshot));
  return hash.value();
}

}  // namespace

/// Each text by a checksum of its own, so that no other three texts run together to the same bytes.
std::uint64_t run_identity(const std::string& version, const std::string& options, const std::string& world) {
  StateHash hash;
  for (const std::string* text : {&version, &options, &world})
    hash.add(checksum(std::as_bytes(std::span(*text))));
  return hash.value();
}

/// The same row, snapshot and identity give the same bytes: no time of day and no random number is in
/// them.
std::vector<std::byte> sealed(const ResumePoint& row, std::span<const std::byte> snapshot,
                              std::uint64_t identity) {
  Header header;
  header.length = snapshot.size();
  header.checksum = seal_of(row, snapshot, identity);
  std::vector<std::byte> bytes(sizeof header + snapshot.size());
  std::memcpy(bytes.data(), &header, sizeof header);
  std::copy(snapshot.begin(), snapshot.end(), bytes.begin() + sizeof header);
  return bytes;
}

// Whatever the bytes are, none is read beyond their end, and no snapshot is given out whose checksum
// does not hold.
std::vector<std::byte> unsealed(const ResumePoint& point, std::uint64_t identity) {
  // The cheap checks first: the checksum reads everything, and its length must be right.
  const Header known;
  Header header;
  if (point.state.size() < sizeof header) throw BadInput("the state is cut");
  std::memcpy(&header, point.state.data(), sizeof header);
  if (std::memcmp(header.magic, known.magic, sizeof known.magic) != 0)
    throw BadInput("the state is not a sealed checkpoint");
  if (header.version != known.version || header.unused != 0)
    throw BadInput("the state is of another version of checkpoints");
  const auto snapshot = std::span(point.state).subspan(sizeof header);
  if (header.length != snapshot.size()) throw BadInput("the state is cut or has grown");
  if (header.checksum != seal_of(point, snapshot, identity))
    throw BadInput("the checksum is wrong: it was damaged, or is of another run");
  return {snapshot.begin(), snapshot.end()};
}

}  // namespace brink
