#include "mbd_server/io/state_file.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include "common/error.hpp"
#include "common/hdf5_handle.hpp"
#include "mbd_server/state/fields.hpp"

namespace tandem::mbd {
namespace {

constexpr const char* kind = "tandem multibody state";
constexpr std::uint64_t version = 2;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem,
                       const std::string& hint = {}) {
  throw Error(ErrorCode::resource, problem, path.string(), hint);
}

struct Handle : Hdf5Handle {
  Handle(hid_t id, herr_t (*close)(hid_t), const std::filesystem::path& path, const char* deed)
      : Hdf5Handle(id, close, [&] {
          fail(path, std::string(deed) + " failed", "is the disk full, or the file damaged?");
        }) {}
};

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
Type type_of(const char*) {
  return {H5T_NATIVE_CHAR, H5T_STD_I8LE};
}

class File {
 public:
  File(const std::filesystem::path& path, hid_t id)
      : path_(path), id_(id, H5Fclose, path, "opening the file") {}

  template <class T>
  void write(const char* name, const T* values, std::size_t size) {
    const hsize_t length = size;
    const Handle space(H5Screate_simple(1, &length, nullptr), H5Sclose, path_, "writing");
    const Handle set(
        H5Dcreate2(id_, name, type_of(values).file, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
        path_, "writing");
    if (size > 0 && H5Dwrite(set, type_of(values).memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
      fail(path_, fmt::format("writing '{}' failed", name), "is the disk full?");
  }
  void flush() {
    if (H5Fflush(id_, H5F_SCOPE_GLOBAL) < 0) fail(path_, "writing failed", "is the disk full?");
  }

  std::size_t size(const char* name) const {
    const Handle set = open(name), space(H5Dget_space(set), H5Sclose, path_, "reading");
    return static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  }
  template <class T>
  void read(const char* name, T* values, std::size_t expected) const {
    if (const std::size_t found = size(name); found != expected)
      fail(path_, fmt::format("'{}' has {} values, not {}", name, found, expected), "the file is damaged");
    const Handle set = open(name);
    if (expected > 0 && H5Dread(set, type_of(values).memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
      fail(path_, fmt::format("reading '{}' failed", name), "the file is damaged");
  }
  std::string text(const char* name) const {
    std::string text(size(name), '\0');
    read(name, text.data(), text.size());
    return text;
  }

 private:
  Handle open(const char* name) const {
    return {H5Lexists(id_, name, H5P_DEFAULT) > 0 ? H5Dopen2(id_, name, H5P_DEFAULT) : -1, H5Dclose, path_,
            (std::string("reading '") + name + "'").c_str()};
  }
  const std::filesystem::path& path_;
  Handle id_;
};

// What makes a state one of this machine's: its coordinates and the equations of its loops.
std::string machine(const Model& model) {
  std::string text;
  for (const std::string& name : model.coordinate_names) text += name + "\n";
  for (const Closure& closure : model.closures)
    for (const Equation& equation : closure.equations) text += closure.name + ": " + equation.what + "\n";
  return text + fmt::format("{} boundary bodies, {} inputs\n", model.boundary.size(), model.inputs);
}

// The first line in which the texts differ.
std::pair<std::string, std::string> difference(const std::string& a, const std::string& b) {
  std::size_t i = 0, line = 0;
  for (; i < a.size() && i < b.size() && a[i] == b[i]; ++i)
    if (a[i] == '\n') line = i + 1;
  return {a.substr(line, a.find('\n', line) - line), b.substr(line, b.find('\n', line) - line)};
}

}  // namespace

void write_state(const std::filesystem::path& path, const Model& model, const State& state) {
  const Quiet quiet;
  std::filesystem::path part = path;
  part += ".part";
  {
    File file(part, H5Fcreate(part.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    const std::string head = kind, of = machine(model);
    file.write("kind", head.data(), head.size());
    file.write("version", &version, 1);
    file.write("machine", of.data(), of.size());
    for_each_field(state, [&]<class Field>(const char* name, const Field& field) {
      if constexpr (std::is_arithmetic_v<Field>)
        file.write(name, &field, 1);
      else
        file.write(name, field.data(), static_cast<std::size_t>(field.size()));
    });
    file.flush();
  }
  std::error_code failure;
  std::filesystem::rename(part, path, failure);
  if (failure) fail(path, "cannot be put into place: " + failure.message());
}

State read_state(const std::filesystem::path& path, const Model& model) {
  const Quiet quiet;
  if (!std::filesystem::exists(path)) fail(path, "does not exist", "give the path of a saved state");
  const File file(path, H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  if (file.text("kind") != kind) fail(path, "is no state of a multibody system");
  std::uint64_t found = 0;
  file.read("version", &found, 1);
  if (found != version)
    fail(path, fmt::format("is of version {}, this program reads {}", found, version),
         "go on with the program that wrote it");
  if (const std::string of = file.text("machine"), ours = machine(model); of != ours) {
    const auto [theirs, here] = difference(of, ours);
    throw Error(ErrorCode::scene,
                "is the state of another machine: it has '" + theirs + "' where the scene has '" + here + "'",
                path.string(), "give the scene that the state was saved from");
  }
  State state;
  state.q.setZero(model.coordinates);
  state.u.setZero(model.freedoms);
  state.udot = state.a = state.u;
  state.lambda.setZero(model.equations);
  state.inputs.setZero(model.inputs);
  state.loads.setZero(6, std::ssize(model.boundary));
  state.load_rates = state.loads;
  if (file.size("coarse") > 0) state.coarse = state.fine = VectorXd::Zero(packed_size(state));
  for_each_field(state, [&]<class Field>(const char* name, Field& field) {
    if constexpr (std::is_arithmetic_v<Field>)
      file.read(name, &field, 1);
    else
      file.read(name, field.data(), static_cast<std::size_t>(field.size()));
  });
  return state;
}

}  // namespace tandem::mbd
