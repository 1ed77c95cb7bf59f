#include "coordinator/report/own_picture.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

#include "common/error.hpp"
#include "common/file_draft.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

// A PNG file begins with a signature of 8 bytes and the chunk IHDR of 25 bytes.
constexpr std::size_t png_head = 33;
// The mark of a film is in its index, which is at its begin and grows with its length.
constexpr std::size_t searched = std::size_t{64} << 20;  // [bytes]

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>((value >> shift) & 0xff);
  return bytes;
}

// The checksum of a PNG chunk (ISO/IEC 15948, 5.5).
std::uint32_t crc(std::string_view bytes) {
  std::uint32_t sum = 0xffffffff;
  for (const char byte : bytes) {
    sum ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ ((sum & 1) != 0 ? 0xedb88320 : 0);
  }
  return ~sum;
}

bool has_mark(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string begin(std::min<std::uintmax_t>(fs::file_size(path), searched), '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin.find(own_mark) != std::string::npos;
}

}  // namespace

void expect_own_or_new(const fs::path& file) {
  std::error_code unknown;
  const fs::file_status status = fs::symlink_status(file, unknown);
  if (status.type() == fs::file_type::not_found) return;
  if (status.type() == fs::file_type::regular && has_mark(file)) return;
  throw Error(ErrorCode::usage, "is there, and is not a picture or film of tandem: it would be overwritten",
              file.string(), "give another name, or delete it");
}

void mark_picture(const fs::path& png) {
  std::ostringstream content;
  content << std::ifstream(png, std::ios::binary).rdbuf();
  const std::string bytes = std::move(content).str();
  if (bytes.size() < png_head || bytes.compare(12, 4, "IHDR") != 0)
    throw Error(ErrorCode::resource, "is no PNG file", png.string(), "POV-Ray did not write it completely");
  const std::string text = std::string("tEXtComment") + '\0' + own_mark;
  replace_file(png, bytes.substr(0, png_head) + big_endian(static_cast<std::uint32_t>(text.size() - 4)) +
                        text + big_endian(crc(text)) + bytes.substr(png_head));
}

}  // namespace tandem::launch
