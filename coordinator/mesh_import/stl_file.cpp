#include "coordinator/mesh_import/stl_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

constexpr std::uint64_t header_bytes = 80 + 4, triangle_bytes = 50;

std::string read(std::ifstream& in, std::uint64_t from, std::uint64_t count) {
  std::string bytes(count, '\0');
  in.seekg(static_cast<std::streamoff>(from));
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  in.clear();
  return bytes;
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// Binary files contain bytes that text does not have.
bool is_text(const std::string& begin) {
  return std::ranges::none_of(begin, [](unsigned char c) { return c < ' ' && !std::isspace(c); });
}

// Many binary files begin with "solid" as well.
bool is_ascii_stl(const std::string& begin) {
  const std::size_t word = begin.find_first_not_of(" \t\r\n");
  return is_text(begin) && word != std::string::npos && lower(begin.substr(word, 5)) == "solid";
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& problem) {
  throw Error(ErrorCode::scene, problem, file.string(), "copy or export the file once more");
}

}  // namespace

void expect_whole_stl(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(file, error);
  if (!in || error)
    throw Error(ErrorCode::scene, "the mesh file cannot be read", file.string(),
                "check the right to read it");
  if (size == 0) fail(file, "the mesh file is empty");

  const std::string begin = read(in, 0, std::min<std::uint64_t>(size, 1024));
  if (is_ascii_stl(begin)) {
    const std::uint64_t tail = std::min<std::uint64_t>(size, 4096);
    const std::string end = lower(read(in, size - tail, tail));
    const std::size_t closing = end.rfind("endsolid"), facet = end.rfind("endfacet");
    if (closing == std::string::npos || (facet != std::string::npos && facet > closing))
      fail(file,
           fmt::format("the ASCII STL file is cut off: it has {} bytes and does not end with 'endsolid'",
                       size));
    return;
  }
  if (is_text(begin) || size < header_bytes)
    throw Error(ErrorCode::scene,
                fmt::format("is no STL file: it does not begin with 'solid', as ASCII files do, and {}",
                            is_text(begin) ? "is text"
                                           : fmt::format("has {} bytes, where binary ones begin with {}",
                                                         size, header_bytes)),
                file.string(), "give an STL or OBJ file");
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, begin.data() + 80, sizeof triangles);
  const std::uint64_t expected = header_bytes + triangle_bytes * triangles;
  if (size < expected)
    fail(file,
         fmt::format("the binary STL file is cut off: for the {} triangles of its header it should have {} "
                     "bytes, and has {}, enough for {}",
                     triangles, expected, size, (size - header_bytes) / triangle_bytes));
  if (size > expected)
    throw Error(
        ErrorCode::scene,
        fmt::format("the binary STL file has {} bytes, {} more than the {} triangles of its header take",
                    size, size - expected, triangles),
        file.string(), "export the file once more");
}

}  // namespace tandem::launch
