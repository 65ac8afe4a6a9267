/// The text is base64 of one zlib stream over all arrays, in the order of arrays(). An array of n values
/// has n lowest bytes first, then n of the next significance, and so on: inflated() in motion.js puts
/// values together again.
#include "brink/scenes/view/page_numbers.h"

#include <zlib.h>

#include <bit>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>

#include "brink/core/base/error.h"

namespace brink {

// Scripts read arrays in the order of the machine that shows the page, and hardly any that has a browser is
// not little-endian.
static_assert(std::endian::native == std::endian::little, "pages hold little-endian numbers");

template <class T>
void PageNumbers::take(const std::string& name, const char* kind, std::span<const T> values) {
  arrays_.push_back({name, kind, values.size()});
  const auto* from = reinterpret_cast<const unsigned char*>(values.data());
  bytes_.reserve(bytes_.size() + values.size_bytes());
  // Bytes of equal significance follow each other: exponents of neighbours are nearly equal and pack well.
  for (std::size_t byte = 0; byte < sizeof(T); ++byte)
    for (std::size_t i = 0; i < values.size(); ++i) bytes_.push_back(from[i * sizeof(T) + byte]);
}

template void PageNumbers::take(const std::string&, const char*, std::span<const double>);
template void PageNumbers::take(const std::string&, const char*, std::span<const std::int32_t>);

std::string PageNumbers::text(bool quick) const {
  // In memory as a whole: ReplayLimits keep the numbers of a page within bounds. Level 6 is zlib's own
  // choice between time and size.
  uLongf size = compressBound(bytes_.size());
  std::vector<unsigned char> packed(size);
  if (compress2(packed.data(), &size, bytes_.data(), bytes_.size(), quick ? 1 : 6) != Z_OK)
    throw IoError("the numbers of a page cannot be compressed");
  packed.resize(size);
  // Base64 takes three bytes at a time: zeros fill the last group, and their digits become the padding.
  const std::size_t missing = (3 - packed.size() % 3) % 3;
  packed.insert(packed.end(), missing, 0);
  namespace it = boost::archive::iterators;
  using Base64 = it::base64_from_binary<it::transform_width<const unsigned char*, 6, 8>>;
  std::string text(Base64(packed.data()), Base64(packed.data() + packed.size()));
  text.replace(text.size() - missing, missing, missing, '=');
  return text;
}

}  // namespace brink
