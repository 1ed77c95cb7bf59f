#include "coordinator/results/series/hdf5.hpp"

#include <hdf5.h>

#include <algorithm>

#include "common/file_draft.hpp"
#include "common/hdf5_handle.hpp"
#include "coordinator/results/disk_error.hpp"

namespace tandem::launch {
namespace {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

// The innermost entry of HDF5's error stack: only this one has the reason given by the system.
std::string innermost_error() {
  std::string text;
  const auto keep_first = [](unsigned depth, const H5E_error2_t* entry, void* out) -> herr_t {
    if (depth == 0 && entry->desc != nullptr) *static_cast<std::string*>(out) = entry->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &text);
  return text;
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& deed) {
  if (deed.starts_with("cannot read") || deed.starts_with("cannot open"))
    throw Error(ErrorCode::resource, deed + ": " + innermost_error(), file.string(),
                "the file, or one that it links to, is damaged or missing");
  fail_on_disk(file, deed + ": " + innermost_error());
}

// Errors are thrown, not printed. The library keeps that setting per thread, and frames are written by
// separate threads.
void hush() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

struct Handle : Hdf5Handle {
  Handle(hid_t id, herr_t (*close)(hid_t), const std::filesystem::path& file, const std::string& deed)
      : Hdf5Handle(id, close, [&] { fail(file, deed); }) {}
};

template <class T>
struct Type;
template <>
struct Type<double> {
  static hid_t memory() { return H5T_NATIVE_DOUBLE; }
  static hid_t file() { return H5T_IEEE_F64LE; }
  static constexpr Number number = Number::float64;
};
template <>
struct Type<float> {
  static hid_t memory() { return H5T_NATIVE_FLOAT; }
  static hid_t file() { return H5T_IEEE_F32LE; }
  static constexpr Number number = Number::float32;
};
template <>
struct Type<std::uint32_t> {
  static hid_t memory() { return H5T_NATIVE_UINT32; }
  static hid_t file() { return H5T_STD_U32LE; }
  static constexpr Number number = Number::uint32;
};
template <>
struct Type<std::int32_t> {
  static hid_t memory() { return H5T_NATIVE_INT32; }
  static hid_t file() { return H5T_STD_I32LE; }
  static constexpr Number number = Number::int32;
};

template <class T>
DatasetInfo write_array(hid_t file, const std::filesystem::path& path, const std::string& name,
                        std::span<const T> values, std::size_t columns, Storage storage) {
  hush();
  const std::string deed = "cannot write " + name;
  const DatasetInfo info{{}, name, values.size() / columns, columns, Type<T>::number};
  const hsize_t extent[2] = {info.rows, columns};
  const int rank = columns == 1 ? 1 : 2;
  const Handle space(H5Screate_simple(rank, extent, nullptr), H5Sclose, path, deed);
  const Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose, path, deed);
  H5Pset_create_intermediate_group(link, 1);
  const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path, deed);
  H5Pset_obj_track_times(layout, false);  // the same run writes the same bytes
  if (storage == Storage::compressed && info.rows > 0) {
    const hsize_t chunk[2] = {std::min<hsize_t>(info.rows, 65536), columns};
    H5Pset_chunk(layout, rank, chunk);
    H5Pset_shuffle(layout);
    H5Pset_deflate(layout, 1);
  }
  const Handle dataset(H5Dcreate2(file, name.c_str(), Type<T>::file(), space, link, layout, H5P_DEFAULT),
                       H5Dclose, path, deed);
  if (info.rows > 0 &&
      H5Dwrite(dataset, Type<T>::memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    fail(path, deed);
  }
  return info;
}

template <class T>
std::vector<T> read_array(hid_t file, const std::filesystem::path& path, const std::string& name) {
  const std::string deed = "cannot read " + name;
  const Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, path, deed);
  const Handle space(H5Dget_space(dataset), H5Sclose, path, deed);
  std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  if (!values.empty() &&
      H5Dread(dataset, Type<T>::memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
    fail(path, deed);
  }
  return values;
}

}  // namespace

Hdf5File Hdf5File::create(const std::filesystem::path& path) {
  hush();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, path, "cannot make the file");
  // The file in memory grows by this number of bytes; the library never writes it to the disk.
  constexpr std::size_t increment = std::size_t{1} << 20;
  if (H5Pset_fapl_core(access, increment, false) < 0) fail(path, "cannot make the file");
  const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (id < 0) fail(path, "cannot make the file");
  return {path, id};
}

Hdf5File Hdf5File::open(const std::filesystem::path& path) {
  hush();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, path, "cannot open the file");
  H5Pset_file_locking(access, false, true);
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
  if (id < 0) fail(path, "cannot open the file");
  return {path, id};
}

Hdf5File::~Hdf5File() {
  if (id_ >= 0) H5Fclose(id_);
}

DatasetInfo Hdf5File::write(const std::string& dataset, std::span<const double> values, std::size_t columns,
                            Storage storage) {
  return write_array(id_, path_, dataset, values, columns, storage);
}
DatasetInfo Hdf5File::write(const std::string& dataset, std::span<const float> values, std::size_t columns,
                            Storage storage) {
  return write_array(id_, path_, dataset, values, columns, storage);
}
DatasetInfo Hdf5File::write(const std::string& dataset, std::span<const std::uint32_t> values,
                            std::size_t columns, Storage storage) {
  return write_array(id_, path_, dataset, values, columns, storage);
}
DatasetInfo Hdf5File::write(const std::string& dataset, std::span<const std::int32_t> values,
                            std::size_t columns, Storage storage) {
  return write_array(id_, path_, dataset, values, columns, storage);
}

void Hdf5File::make_group(const std::string& group) {
  hush();
  const Handle made(H5Gcreate2(id_, group.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, path_,
                    "cannot make group " + group);
}

void Hdf5File::link(const std::string& name, const std::string& file) {
  hush();
  if (H5Lcreate_external(file.c_str(), "/", id_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT) < 0)
    fail(path_, "cannot make link " + name);
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, double value) {
  hush();
  const std::string deed = "cannot write attribute " + name + " of " + object;
  const Handle owner(H5Oopen(id_, object.c_str(), H5P_DEFAULT), H5Oclose, path_, deed);
  if (H5Aexists(owner, name.c_str()) > 0) H5Adelete(owner, name.c_str());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, path_, deed);
  const Handle attribute(H5Acreate2(owner, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, path_, deed);
  if (H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value) < 0) fail(path_, deed);
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, const std::string& value) {
  hush();
  const std::string deed = "cannot write attribute " + name + " of " + object;
  const Handle owner(H5Oopen(id_, object.c_str(), H5P_DEFAULT), H5Oclose, path_, deed);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, path_, deed);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, path_, deed);
  H5Tset_size(type, value.size() + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  const Handle attribute(H5Acreate2(owner, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         path_, deed);
  if (H5Awrite(attribute, type, value.c_str()) < 0) fail(path_, deed);
}

std::vector<double> Hdf5File::read_doubles(const std::string& dataset) const {
  return read_array<double>(id_, path_, dataset);
}
std::vector<std::uint32_t> Hdf5File::read_indices(const std::string& dataset) const {
  return read_array<std::uint32_t>(id_, path_, dataset);
}

double Hdf5File::number_attribute(const std::string& object, const std::string& name) const {
  const std::string deed = "cannot read attribute " + name + " of " + object;
  const Handle attribute(H5Aopen_by_name(id_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, path_, deed);
  double value = 0;
  if (H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0) fail(path_, deed);
  return value;
}

std::string Hdf5File::text_attribute(const std::string& object, const std::string& name) const {
  const std::string deed = "cannot read attribute " + name + " of " + object;
  const Handle attribute(H5Aopen_by_name(id_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, path_, deed);
  const Handle type(H5Aget_type(attribute), H5Tclose, path_, deed);
  std::string value(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, value.data()) < 0) fail(path_, deed);
  return value.c_str();  // without the terminating zero
}

std::vector<std::string> Hdf5File::children(const std::string& group) const {
  const Handle opened(H5Gopen2(id_, group.c_str(), H5P_DEFAULT), H5Gclose, path_, "cannot read " + group);
  std::vector<std::string> names;
  H5Literate(
      opened, H5_INDEX_NAME, H5_ITER_INC, nullptr,
      [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
        static_cast<std::vector<std::string>*>(out)->emplace_back(name);
        return 0;
      },
      &names);
  return names;
}

bool Hdf5File::has(const std::string& path) const {
  for (std::size_t end = path.find('/', 1);;
       end = path.find('/', end + 1)) {  // each group of the path must exist
    if (H5Lexists(id_, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return true;
  }
}

void Hdf5File::commit() {
  hush();
  if (H5Fflush(id_, H5F_SCOPE_GLOBAL) < 0) fail(path_, "cannot make the file");
  const ssize_t size = H5Fget_file_image(id_, nullptr, 0);
  if (size < 0) fail(path_, "cannot make the file");
  std::string image(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(id_, image.data(), image.size()) < 0) fail(path_, "cannot make the file");
  replace_file(path_, image);
}

}  // namespace tandem::launch
