// A state on disk, from which a run continues: an HDF5 file of named arrays with the kind of the state and
// the version of its layout. Values are restored to the bit. The first line of the file, in the user block of
// HDF5, is a digest of the rest, so that a changed byte is detected.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace tandem {

class StateWriter {
 public:
  // Throws Error{resource} where the file cannot be written; so do the functions below.
  StateWriter(std::filesystem::path path, const std::string& kind, std::uint64_t version);
  ~StateWriter();  // without commit() no file is left
  StateWriter(const StateWriter&) = delete;
  StateWriter& operator=(const StateWriter&) = delete;

  // `name` may have groups: "accounts/energy".
  void write(const std::string& name, std::span<const double> values);
  void write(const std::string& name, std::span<const std::uint64_t> values);
  void write(const std::string& name, std::span<const std::byte> values);
  void write(const std::string& name, double value) { write(name, std::span(&value, 1)); }
  void write(const std::string& name, std::uint64_t value) { write(name, std::span(&value, 1)); }
  void write(const std::string& name, const std::string& text) {
    write(name, std::as_bytes(std::span(text)));
  }
  // Moves the file to its place on the disk: it is complete or absent.
  void commit();

 private:
  struct File;
  explicit StateWriter(std::filesystem::path path);
  void reserve(std::size_t bytes);
  std::filesystem::path path_, part_;  // part_: temporary path, empty once the file is in its place
  std::unique_ptr<File> file_;
};

// Waits until a file, or the names in a folder, are stored on the disk and survive a loss of power. Throws
// Error{resource} where that fails.
void flush_to_disk(const std::filesystem::path& path);

// Identifies a file: by the digest in a state, which is not checked here; for a file of another program by
// the digest of all its bytes. Throws Error{resource} where it cannot be read.
std::uint64_t file_digest(const std::filesystem::path& path);

class StateReader {
 public:
  // Throws Error{resource} where the file is missing, is damaged, or is of another kind or version.
  StateReader(std::filesystem::path path, const std::string& kind, std::uint64_t version);
  ~StateReader();
  StateReader(const StateReader&) = delete;
  StateReader& operator=(const StateReader&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::size_t size(const std::string& name) const;
  // Throws unless the array has exactly that number of values.
  void read(const std::string& name, std::span<double> values) const;
  void read(const std::string& name, std::span<std::uint64_t> values) const;
  void read(const std::string& name, std::span<std::byte> values) const;
  void read(const std::string& name, double& value) const { read(name, std::span(&value, 1)); }
  void read(const std::string& name, std::uint64_t& value) const { read(name, std::span(&value, 1)); }
  std::string text(const std::string& name) const;

 private:
  struct File;
  std::filesystem::path path_;
  std::unique_ptr<File> file_;
};

}  // namespace tandem
