// A file that is replaced as a whole: whoever reads it meanwhile, or after this program died at any moment,
// finds the old one or the new one, never a part.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace tandem {

enum class Durability {
  program,  // survives the death of this program
  power,    // survives a loss of power too: waits for the disk
};

// Written as FILE.new and then renamed. Each call throws Error{resource} where the disk does not take it;
// nothing is left of a draft that is not committed.
class FileDraft {
 public:
  explicit FileDraft(std::filesystem::path file);
  ~FileDraft();
  FileDraft(const FileDraft&) = delete;
  FileDraft& operator=(const FileDraft&) = delete;

  void append(std::string_view bytes);
  // The first `size` bytes of another file.
  void append_from(const std::filesystem::path& source, std::uint64_t size);
  void commit(Durability durability = Durability::program);

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path file_, draft_;
  int descriptor_ = -1;
};

void replace_file(const std::filesystem::path& file, std::string_view contents,
                  Durability durability = Durability::program);

// Writes all bytes; false, with errno, where the disk does not take them.
bool write_all(int descriptor, std::string_view bytes);

}  // namespace tandem
