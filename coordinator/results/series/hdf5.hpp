// HDF5 files with the few calls that the results need. A file is built in memory and then written to its
// place as a whole, because the library may crash when the disk fails. Every failure is an Error{resource}
// that names the file and contains the innermost message of the library or of the system ("No space left on
// device").
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tandem::launch {

enum class Number { float64, float32, uint32, int32 };

// A dataset, as another file (XDMF) refers to it.
struct DatasetInfo {
  std::string file;  // relative to the run's folder, "frames/particles_000003.h5"
  std::string path;  // inside the file, "/position"
  std::size_t rows = 0;
  std::size_t columns = 1;
  Number number{};
};

enum class Storage { plain, compressed };

class Hdf5File {
 public:
  // The file is in memory until commit(), which replaces an old file of this name.
  static Hdf5File create(const std::filesystem::path& path);
  static Hdf5File open(const std::filesystem::path& path);  // for reading
  ~Hdf5File();
  Hdf5File(Hdf5File&& other) noexcept : path_(std::move(other.path_)), id_(std::exchange(other.id_, -1)) {}
  Hdf5File& operator=(Hdf5File&&) = delete;

  const std::filesystem::path& path() const { return path_; }

  // Writes values (rows x columns) as a new dataset and creates missing groups of its path.
  DatasetInfo write(const std::string& dataset, std::span<const double> values, std::size_t columns = 1,
                    Storage storage = Storage::plain);
  DatasetInfo write(const std::string& dataset, std::span<const float> values, std::size_t columns = 1,
                    Storage storage = Storage::plain);
  DatasetInfo write(const std::string& dataset, std::span<const std::uint32_t> values,
                    std::size_t columns = 1, Storage storage = Storage::plain);
  DatasetInfo write(const std::string& dataset, std::span<const std::int32_t> values, std::size_t columns = 1,
                    Storage storage = Storage::plain);
  void make_group(const std::string& group);
  // `name` becomes a link to the root of another file, whose path is relative to the folder of this one.
  void link(const std::string& name, const std::string& file);
  void set_attribute(const std::string& object, const std::string& name, double value);
  void set_attribute(const std::string& object, const std::string& name, const std::string& value);

  // Numbers are converted to the requested type.
  std::vector<double> read_doubles(const std::string& dataset) const;
  std::vector<std::uint32_t> read_indices(const std::string& dataset) const;
  double number_attribute(const std::string& object, const std::string& name) const;
  std::string text_attribute(const std::string& object, const std::string& name) const;
  std::vector<std::string> children(const std::string& group) const;  // names, ascending
  bool has(const std::string& path) const;

  void commit();

 private:
  Hdf5File(std::filesystem::path path, std::int64_t id) : path_(std::move(path)), id_(id) {}

  std::filesystem::path path_;
  std::int64_t id_;
};

}  // namespace tandem::launch
