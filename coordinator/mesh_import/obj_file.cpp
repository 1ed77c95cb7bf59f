#include "coordinator/mesh_import/obj_file.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <vector>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

// Counts the corners of the faces of a text that comes in pieces, in constant memory: a line may be as long
// as the file. Takes for a face what the importer takes for one: a line whose first word begins with f. After
// a backslash the line continues in the next one.
class FaceCounter {
 public:
  // Returns whether a face has too many corners; then line() is where it begins.
  bool count(char c) {
    if (c == '\n') ++line_;
    if (continued_) {
      continued_ = c != '\n';
    } else if (c == '\n' || c == '\r' || c == '\f' || c == '\0') {
      words_ = 0, in_word_ = is_face_ = false;
    } else if (c == ' ' || c == '\t' || c == '\\') {
      in_word_ = false, continued_ = c == '\\';
    } else if (!in_word_) {
      in_word_ = true;
      if (++words_ == 1) is_face_ = c == 'f', begin_ = line_;
      return is_face_ && words_ > most_corners + 1;
    }
    return false;
  }
  std::uint64_t line() const { return begin_; }

 private:
  std::uint64_t line_ = 1, begin_ = 1;
  std::size_t words_ = 0;  // of the line so far
  bool in_word_ = false, is_face_ = false, continued_ = false;
};

}  // namespace

void expect_short_faces(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<char> piece(std::size_t{1} << 20);
  FaceCounter counter;
  while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())), in.gcount() > 0)
    for (std::streamsize i = 0; i < in.gcount(); ++i)
      if (counter.count(piece[static_cast<std::size_t>(i)]))
        throw Error(ErrorCode::scene,
                    fmt::format("the face of line {} has more than {} corners", counter.line(), most_corners),
                    file.string(), "cut it into triangles in the program that made it");
}

}  // namespace tandem::launch
