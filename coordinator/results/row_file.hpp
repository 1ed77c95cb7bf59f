// A text file to which whole lines are appended. The file on the disk ends with a complete line also when the
// disk is full, and a later run can continue from any earlier length of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace tandem::launch {

// A position between two lines of a row file.
struct RowMark {
  std::uint64_t size = 0;    // bytes before it
  std::uint64_t digest = 0;  // of these bytes
  std::uint64_t lines = 0;
};

class RowFile {
 public:
  // Creates a new file with this first line, given without its line break.
  RowFile(std::filesystem::path file, std::string_view header);
  ~RowFile();
  RowFile(const RowFile&) = delete;
  RowFile& operator=(const RowFile&) = delete;

  const std::filesystem::path& path() const { return file_; }
  // Appends whole lines, with their line breaks. They are in the file when this returns, so that readers of
  // a run in progress, or of one that was killed, find them. Throws Error{resource} where the disk is full;
  // then none of them is in the file.
  void append(std::string_view lines);
  const RowMark& end() const { return end_; }

  // Replaces the content by that of another row file up to `mark`. Throws Error{resource} where the source
  // is missing or has changed since.
  void begin_with(const std::filesystem::path& source, const RowMark& mark);
  // Waits until the lines so far are stored on the disk.
  void flush_to_disk() const;

 private:
  [[noreturn]] void fail(int error);
  void count(std::string_view bytes);

  std::filesystem::path file_;
  int descriptor_ = -1;
  RowMark end_;
};

}  // namespace tandem::launch
