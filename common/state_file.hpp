// A state on disk, from which a run goes on: an HDF5 file of named arrays with the kind of the state and the
// version of its layout. Values come back to the bit. The first line of the file, in what HDF5 calls its user
// block, is a digest of all the rest, so that no changed byte is taken for a state.
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
  // Error{resource} where the file cannot be written, here and in what follows.
  StateWriter(std::filesystem::path path, const std::string& kind, std::uint64_t version);
  ~StateWriter();  // without commit() nothing is left
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
  // Puts the file into place, on the disk: it is complete or not there.
  void commit();

 private:
  struct File;
  explicit StateWriter(std::filesystem::path path);
  void reserve(std::size_t bytes);
  std::filesystem::path path_, part_;  // part_: where it is written, empty once it is in place
  std::unique_ptr<File> file_;
};

// Waits until a file, or the names in a folder, are on the disk itself: a loss of power keeps them.
// Error{resource} where that fails.
void flush_to_disk(const std::filesystem::path& path);

// What tells a file from others: the digest that a state carries, which is not checked here; of a file of
// another program that of all its bytes. Error{resource} where it cannot be read.
std::uint64_t file_digest(const std::filesystem::path& path);

class StateReader {
 public:
  // Error{resource} where the file is not there, is damaged, or is of another kind or version.
  StateReader(std::filesystem::path path, const std::string& kind, std::uint64_t version);
  ~StateReader();
  StateReader(const StateReader&) = delete;
  StateReader& operator=(const StateReader&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::size_t size(const std::string& name) const;
  // Exactly as many values as there are.
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
