#include <cairo.h>
#include <spdlog/fmt/fmt.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "brink/scenes/draw/draw.h"
#include "brink/scenes/files/written_file.h"

namespace brink {
namespace {

/// Into a stream rather than by cairo_surface_write_to_png(), so that the cause of a failure is known.
cairo_status_t put(void* stream, const unsigned char* data, unsigned int length) {
  auto& out = *static_cast<std::ofstream*>(stream);
  out.write(reinterpret_cast<const char*>(data), length);
  return out ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

}  // namespace

void write_png(const std::filesystem::path& file, const Picture& picture) {
  std::ofstream out(file, std::ios::binary);
  if (!out) throw IoError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
  // Cairo takes pixels that it could write to; writing a PNG only reads them. A row of 32-bit
  // pixels is a stride.
  auto* data = reinterpret_cast<unsigned char*>(const_cast<std::uint32_t*>(picture.pixels.data()));
  cairo_surface_t* surface = cairo_image_surface_create_for_data(data, CAIRO_FORMAT_RGB24, picture.width,
                                                                 picture.height, 4 * picture.width);
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface, put, &out);
  cairo_surface_destroy(surface);
  // Closed before it is asked: what is buffered still may fail on a full disk.
  out.close();
  // A failed write leaves the stream bad: its cause is the system's. The other errors are Cairo's.
  if (!out) throw_not_written(file);
  if (status != CAIRO_STATUS_SUCCESS)
    throw IoError(fmt::format("{}: could not be written: {}", file.string(), cairo_status_to_string(status)));
}

}  // namespace brink
