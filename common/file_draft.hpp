// A file that is replaced as a whole: a reader at any time, also after this program died, finds the old or
// the new file, never a part.
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

// Written as FILE.new and then renamed. Each call throws Error{resource} where the disk refuses it; a draft
// that is not committed is removed.
class FileDraft {
 public:
  explicit FileDraft(std::filesystem::path file);
  ~FileDraft();
  FileDraft(const FileDraft&) = delete;
  FileDraft& operator=(const FileDraft&) = delete;

  void append(std::string_view bytes);
  // Appends the first `size` bytes of another file.
  void append_from(const std::filesystem::path& source, std::uint64_t size);
  void commit(Durability durability = Durability::program);

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path file_, draft_;
  int descriptor_ = -1;
};

void replace_file(const std::filesystem::path& file, std::string_view contents,
                  Durability durability = Durability::program);

// Writes all bytes; returns false, with errno, where the disk refuses them.
bool write_all(int descriptor, std::string_view bytes);

}  // namespace tandem
