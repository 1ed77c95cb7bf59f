#include "common/state_file.hpp"

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/error.hpp"
#include "common/hdf5_handle.hpp"

namespace tandem {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem,
                       const std::string& hint = {}) {
  throw Error(ErrorCode::resource, problem, path.string(), hint);
}

}  // namespace

namespace detail {

struct StateHandle : Hdf5Handle {
  StateHandle(hid_t id, herr_t (*close)(hid_t), const std::filesystem::path& path, const std::string& deed)
      : Hdf5Handle(id, close,
                   [&] { fail(path, deed + " failed", "is the disk full, or the file damaged?"); }) {}
};

}  // namespace detail

namespace {

using Handle = detail::StateHandle;

constexpr const char* kind_name = "kind";
constexpr const char* version_name = "version";

// The library's own printing to stderr is off: errors come as exceptions.
struct Quiet {
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function, &data);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function, data); }
  H5E_auto2_t function = nullptr;
  void* data = nullptr;
};

struct Type {
  hid_t memory, file;
};
Type type_of(const double*) {
  return {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE};
}
Type type_of(const std::uint64_t*) {
  return {H5T_NATIVE_UINT64, H5T_STD_U64LE};
}
Type type_of(const std::byte*) {
  return {H5T_NATIVE_UCHAR, H5T_STD_U8LE};
}

template <class T>
void write_array(hid_t file, const std::filesystem::path& path, const std::string& name,
                 std::span<const T> values) {
  const Quiet quiet;
  const std::string deed = "writing '" + name + "'";
  const hsize_t length = values.size();
  const Handle space(H5Screate_simple(1, &length, nullptr), H5Sclose, path, deed);
  const Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose, path, deed);
  H5Pset_create_intermediate_group(link, 1);
  // Chunks, since only those can have checksums: reading fails where one is wrong.
  const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path, deed);
  const hsize_t chunk = std::min<hsize_t>(length, hsize_t{1} << 17);
  if (chunk > 0 && (H5Pset_chunk(layout, 1, &chunk) < 0 || H5Pset_fletcher32(layout) < 0))
    fail(path, deed + " failed");
  const Handle set(
      H5Dcreate2(file, name.c_str(), type_of(values.data()).file, space, link, layout, H5P_DEFAULT), H5Dclose,
      path, deed);
  if (!values.empty() &&
      H5Dwrite(set, type_of(values.data()).memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    fail(path, deed + " failed", "is the disk full?");
}

}  // namespace

struct StateWriter::File {
  detail::StateHandle id;
};
struct StateReader::File {
  detail::StateHandle id;
};

void flush_to_disk(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool done = file >= 0 && fsync(file) == 0;
  const int failure = errno;
  if (file >= 0) close(file);
  // Some file systems keep the names of folders by themselves, and say EINVAL.
  if (!done && failure != EINVAL)
    fail(path, std::string("cannot be flushed to the disk: ") + strerror(failure));
}

StateWriter::StateWriter(std::filesystem::path path) : path_(std::move(path)), part_(path_) {
  part_ += ".part";
  const Quiet quiet;
  file_.reset(new File{Handle(H5Fcreate(part_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose,
                              part_, "making the file")});
}

// Delegates, so that the destructor cleans up where this throws.
StateWriter::StateWriter(std::filesystem::path path, const std::string& kind, std::uint64_t version)
    : StateWriter(std::move(path)) {
  write(kind_name, kind);
  write(version_name, version);
}

StateWriter::~StateWriter() {
  if (part_.empty()) return;
  const Quiet quiet;
  file_.reset();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void StateWriter::write(const std::string& name, std::span<const double> values) {
  write_array(file_->id, part_, name, values);
}
void StateWriter::write(const std::string& name, std::span<const std::uint64_t> values) {
  write_array(file_->id, part_, name, values);
}
void StateWriter::write(const std::string& name, std::span<const std::byte> values) {
  write_array(file_->id, part_, name, values);
}

void StateWriter::commit() {
  const Quiet quiet;
  if (H5Fflush(file_->id, H5F_SCOPE_GLOBAL) < 0 || file_->id.close_now() < 0)
    fail(part_, "writing failed", "is the disk full?");
  flush_to_disk(part_);
  std::error_code failure;
  std::filesystem::rename(part_, path_, failure);
  if (failure) fail(path_, "cannot be put into place: " + failure.message());
  part_.clear();
  flush_to_disk(path_.parent_path().empty() ? "." : path_.parent_path());
}

namespace {

Handle open_array(hid_t file, const std::filesystem::path& path, const std::string& name) {
  return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, path, "reading '" + name + "'"};
}

std::size_t length_of(hid_t space, const std::filesystem::path& path, const std::string& name) {
  const hssize_t length = H5Sget_simple_extent_npoints(space);
  if (length < 0) fail(path, "reading '" + name + "' failed", "the file is damaged");
  return static_cast<std::size_t>(length);
}

template <class T>
void read_array(hid_t file, const std::filesystem::path& path, const std::string& name, std::span<T> values) {
  const Quiet quiet;
  const std::string deed = "reading '" + name + "'";
  const Handle set = open_array(file, path, name);
  const Handle space(H5Dget_space(set), H5Sclose, path, deed);
  const std::size_t found = length_of(space, path, name);
  if (found != values.size())
    fail(path,
         "'" + name + "' has " + std::to_string(found) + " values, not " + std::to_string(values.size()),
         "the file is damaged, or of another build");
  if (found > 0 &&
      H5Dread(set, type_of(values.data()).memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    fail(path, deed + " failed", "the file is damaged");
}

}  // namespace

StateReader::StateReader(std::filesystem::path path, const std::string& kind, std::uint64_t version)
    : path_(std::move(path)) {
  if (!std::filesystem::exists(path_)) fail(path_, "does not exist", "give the path of a saved state");
  const Quiet quiet;
  file_.reset(new File{
      Handle(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, path_, "opening the file")});
  if (const std::string found = text(kind_name); found != kind)
    fail(path_, "is a '" + found + "', not a '" + kind + "'");
  std::uint64_t found = 0;
  read(version_name, found);
  if (found != version)
    fail(path_, "is of version " + std::to_string(found) + ", this program reads " + std::to_string(version),
         "go on with the program that wrote it");
}

StateReader::~StateReader() = default;

std::size_t StateReader::size(const std::string& name) const {
  const Quiet quiet;
  const Handle set = open_array(file_->id, path_, name),
               space(H5Dget_space(set), H5Sclose, path_, "reading '" + name + "'");
  return length_of(space, path_, name);
}

void StateReader::read(const std::string& name, std::span<double> values) const {
  read_array(file_->id, path_, name, values);
}
void StateReader::read(const std::string& name, std::span<std::uint64_t> values) const {
  read_array(file_->id, path_, name, values);
}
void StateReader::read(const std::string& name, std::span<std::byte> values) const {
  read_array(file_->id, path_, name, values);
}

std::string StateReader::text(const std::string& name) const {
  std::string text(size(name), '\0');
  read(name, std::as_writable_bytes(std::span(text)));
  return text;
}

}  // namespace tandem
