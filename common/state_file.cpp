#include "common/state_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>

#include "common/error.hpp"
#include "common/hdf5_handle.hpp"
#include "common/input_file.hpp"
#include "common/mix_word.hpp"
#include "common/utf8.hpp"

namespace tandem {
namespace {

// All files are closed by their owners. The library's own exit handler crashes on a file that it could not
// flush because the disk is full; it must be disabled before any other call of the library.
[[maybe_unused]] const herr_t no_exit_handler = H5dont_atexit();

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

// Size of the user block at a file's begin, which the library does not use: a power of two, at least 512.
constexpr std::size_t front_size = 512;
constexpr std::string_view title = "tandem state file, digest ";

class Digest {
 public:
  void add(const char* data, std::size_t size) {
    length_ += size;
    for (std::size_t at = 0; at < size; at += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, data + at, std::min(size - at, sizeof word));
      digest_ = mix_word(digest_, word);
    }
  }
  std::uint64_t value() const { return mix_word(digest_, length_); }

 private:
  std::uint64_t digest_ = 0, length_ = 0;
};

// Digest of all bytes from the present position on.
std::uint64_t digest_of_rest(std::istream& file, const std::filesystem::path& path) {
  Digest digest;
  std::vector<char> piece(std::size_t{1} << 20);  // whole words
  while (file.read(piece.data(), static_cast<std::streamsize>(piece.size())), file.gcount() > 0)
    digest.add(piece.data(), static_cast<std::size_t>(file.gcount()));
  if (!file.eof()) fail(path, "cannot be read");
  return digest.value();
}

std::string front_with(std::uint64_t digest) {
  std::string front = fmt::format("{}{:016x}\n", title, digest);
  front.resize(front_size, '\0');
  return front;
}

// The digest that the file contains, if it is a state; the stream is then at the end of the user block.
std::optional<std::uint64_t> stated_digest(std::istream& file) {
  std::string front(front_size, '\0');
  if (!file.read(front.data(), front_size) || !front.starts_with(title)) return {};
  std::uint64_t digest = 0;
  const char* number = front.data() + title.size();
  if (std::from_chars(number, number + 16, digest, 16).ec != std::errc() || front != front_with(digest))
    return {};
  return digest;
}

std::ifstream opened(const std::filesystem::path& path) {
  expect_input(path, {.code = ErrorCode::resource,
                      .largest = std::numeric_limits<std::int64_t>::max(),  // read in pieces
                      .hint = "servers on other hosts need a disk that all hosts share"});
  return std::ifstream(path, std::ios::binary);
}

void expect_intact(const std::filesystem::path& path) {
  std::ifstream file = opened(path);
  const std::optional<std::uint64_t> stated = stated_digest(file);
  if (!stated)
    fail(path, "is no state of this version, or is damaged", "start anew, or continue from another");
  if (digest_of_rest(file, path) != *stated)
    fail(path, "is damaged: its digest does not fit", "start anew, or continue from another checkpoint");
}

void sign(const std::filesystem::path& path) {
  const int held = open(path.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  std::fstream file("/proc/self/fd/" + std::to_string(held), std::ios::in | std::ios::out | std::ios::binary);
  if (held >= 0) close(held);
  file.seekg(front_size);
  const std::string front = front_with(digest_of_rest(file, path));
  file.clear();
  file.seekp(0);
  if (!file.write(front.data(), front_size).flush()) fail(path, "writing failed", "is the disk full?");
}

constexpr const char* kind_name = "kind";
constexpr const char* version_name = "version";

// Disables the library's own printing to stderr: errors are exceptions.
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
  // without the time of day, so that equal states are equal files
  const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path, deed);
  if (H5Pset_obj_track_times(layout, false) < 0) fail(path, deed + " failed");
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
  int descriptor = -1;             // of the same file, for reserve()
  off_t needed = 0, reserved = 0;  // [bytes]
  ~File() {
    if (descriptor >= 0) close(descriptor);
  }
};
struct StateReader::File {
  detail::StateHandle id;
};

void flush_to_disk(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool done = file >= 0 && fsync(file) == 0;
  const int failure = errno;
  if (file >= 0) close(file);
  // Some file systems make the names in folders durable by themselves, and return EINVAL.
  if (!done && failure != EINVAL)
    fail(path, std::string("cannot be flushed to the disk: ") + strerror(failure));
}

StateWriter::StateWriter(std::filesystem::path path) : path_(std::move(path)), part_(path_) {
  part_ += ".part";
  const Quiet quiet;
  const Handle layout(H5Pcreate(H5P_FILE_CREATE), H5Pclose, part_, "making the file");
  if (H5Pset_userblock(layout, front_size) < 0) fail(part_, "making the file failed");
  // Created anew: an existing entry may be a link to another file, which would be overwritten.
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
  file_.reset(new File{.id = Handle(H5Fcreate(part_.c_str(), H5F_ACC_EXCL, layout, H5P_DEFAULT), H5Fclose,
                                    part_, "making the file")});
  file_->descriptor = open(part_.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file_->descriptor < 0) fail(part_, std::string("cannot be opened: ") + strerror(errno));
}

// Reserves space on the disk for an array before the library writes it, because the library does not tolerate
// a full disk.
void StateWriter::reserve(std::size_t bytes) {
  // Additional data of the library: its header, and for each array names, types and indices.
  constexpr off_t front = 16 << 10, per_array = 4 << 10, step = 64 << 10;
  File& file = *file_;
  file.needed += static_cast<off_t>(bytes) + per_array + (file.needed == 0 ? front : 0);
  if (file.needed <= file.reserved) return;
  const off_t end = (file.needed + step - 1) / step * step;
  int failure = 0;
  while (fallocate(file.descriptor, FALLOC_FL_KEEP_SIZE, file.reserved, end - file.reserved) != 0 &&
         (failure = errno) == EINTR)
    failure = 0;
  if (failure == ENOSPC || failure == EDQUOT || failure == EFBIG)
    fail(part_, std::string("cannot be written: ") + strerror(failure), "free some space on the disk");
  // A file system without reservation returns an error for each call; then the library itself detects a
  // full disk.
  file.reserved = end;
}

// Delegates, so that the destructor cleans up when this constructor throws.
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
  reserve(values.size_bytes());
  write_array(file_->id, part_, name, values);
}
void StateWriter::write(const std::string& name, std::span<const std::uint64_t> values) {
  reserve(values.size_bytes());
  write_array(file_->id, part_, name, values);
}
void StateWriter::write(const std::string& name, std::span<const std::byte> values) {
  reserve(values.size_bytes());
  write_array(file_->id, part_, name, values);
}

void StateWriter::commit() {
  const Quiet quiet;
  if (H5Fflush(file_->id, H5F_SCOPE_GLOBAL) < 0 || file_->id.close_now() < 0)
    fail(part_, "writing failed", "is the disk full?");
  // Releases the space that was reserved beyond the end.
  const off_t size = lseek(file_->descriptor, 0, SEEK_END);
  if (size < 0 || ftruncate(file_->descriptor, size) != 0)
    fail(part_, std::string("cannot be written: ") + strerror(errno));
  sign(part_);
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

// Refuses an array longer than its file: the length may be wrong, and memory would be allocated for it.
std::size_t length_of(hid_t space, const std::filesystem::path& path, const std::string& name) {
  const hssize_t length = H5Sget_simple_extent_npoints(space);
  std::error_code failure;
  const auto bytes = std::filesystem::file_size(path, failure);
  if (length < 0 || failure || static_cast<std::uintmax_t>(length) > bytes)
    fail(path, "reading '" + name + "' failed", "the file is damaged");
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
  expect_intact(path_);
  const Quiet quiet;
  file_.reset(new File{
      Handle(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, path_, "opening the file")});
  if (const std::string found = text(kind_name); found != kind)
    fail(path_, "is a '" + printable(shortened(found)) + "', not a '" + kind + "'");
  std::uint64_t found = 0;
  read(version_name, found);
  if (found != version)
    fail(path_, "is of version " + std::to_string(found) + ", this program reads " + std::to_string(version),
         "continue with the program that wrote it");
}

StateReader::~StateReader() = default;

std::uint64_t file_digest(const std::filesystem::path& path) {
  std::ifstream file = opened(path);
  if (const std::optional<std::uint64_t> stated = stated_digest(file)) return *stated;
  file.clear();
  file.seekg(0);
  return digest_of_rest(file, path);
}

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
