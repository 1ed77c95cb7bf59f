#include "tests/support/damaged_state.hpp"

#include <hdf5.h>

#include <cstring>
#include <random>
#include <stdexcept>
#include <vector>

#include "common/state_file.hpp"

namespace tandem::test {
namespace {

struct Array {
  std::string name;
  std::size_t word = 1;  // bytes of a value
  bool real = false;
  std::vector<std::byte> bytes;
};

herr_t add_array(hid_t file, const char* name, const H5L_info_t*, void* arrays) {
  const hid_t set = H5Oopen(file, name, H5P_DEFAULT);
  if (H5Iget_type(set) != H5I_DATASET) return H5Oclose(set);
  const hid_t type = H5Dget_type(set), space = H5Dget_space(set);
  Array array;
  array.name = name;
  array.word = H5Tget_size(type);
  array.real = H5Tget_class(type) == H5T_FLOAT;
  array.bytes.resize(array.word * static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  if (!array.bytes.empty()) H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.bytes.data());
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(set);
  static_cast<std::vector<Array>*>(arrays)->push_back(std::move(array));
  return 0;
}

std::vector<Array> arrays_of(const std::filesystem::path& path) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) throw std::runtime_error("cannot open " + path.string());
  std::vector<Array> arrays;
  H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, add_array, &arrays);
  H5Fclose(file);
  return arrays;
}

template <class T>
std::vector<T> values(const std::vector<std::byte>& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

constexpr std::uint64_t extremes[] = {0,
                                      1,
                                      ~std::uint64_t{0},
                                      0x7fffffff7fffffff,
                                      0x8000000080000000,
                                      0x7ff8000000000000,  // NaN
                                      0x7fc000007fc00000,  // two in single precision
                                      0xfff0000000000000,  // -infinity
                                      0x7fe0000000000000,  // 9e307
                                      0x0000000100000001,
                                      0x40000000};

class Damage {
 public:
  explicit Damage(std::uint64_t seed) : random_(seed) {}

  std::size_t below(std::size_t count) { return random_() % count; }

  std::string apply(Array& array) {
    std::vector<std::byte>& bytes = array.bytes;
    const std::size_t word = array.word;
    switch (bytes.empty() ? 2 : below(5)) {
      case 0: {
        const std::size_t bit = below(bytes.size() * 8);
        bytes[bit / 8] ^= static_cast<std::byte>(1u << bit % 8);
        return "bit " + std::to_string(bit);
      }
      case 1: {
        const std::size_t size = std::min<std::size_t>(bytes.size(), below(2) == 0 ? 8 : 4);
        const std::size_t at = below(bytes.size() / size) * size, which = below(std::size(extremes));
        std::memcpy(bytes.data() + at, &extremes[which], size);
        return "extreme " + std::to_string(which) + " at byte " + std::to_string(at);
      }
      case 2:
        bytes.resize(bytes.size() + word * (1 + below(64)));
        return "a greater length";
      case 3:
        bytes.resize(below(bytes.size() / word) * word);
        return "a smaller length";
      default:
        for (std::byte& byte : bytes) byte = static_cast<std::byte>(random_());
        return "all of it";
    }
  }

 private:
  std::mt19937_64 random_;
};

// Writes the arrays of `from` but its kind and version, which the file gets anyway, after `change` of them.
template <class Change>
void rewrite(const std::filesystem::path& from, const std::filesystem::path& to, Change change) {
  std::vector<Array> arrays = arrays_of(from);
  std::string kind;
  std::uint64_t version = 0;
  std::vector<Array*> contents;
  for (Array& array : arrays) {
    if (array.name == "kind")
      kind.assign(reinterpret_cast<const char*>(array.bytes.data()), array.bytes.size());
    else if (array.name == "version")
      std::memcpy(&version, array.bytes.data(), sizeof version);
    else
      contents.push_back(&array);
  }
  change(contents);
  StateWriter file(to, kind, version);
  for (const Array* array : contents) {
    if (array->word == 1)
      file.write(array->name, std::span<const std::byte>(array->bytes));
    else if (array->real)
      file.write(array->name, std::span<const double>(values<double>(array->bytes)));
    else
      file.write(array->name, std::span<const std::uint64_t>(values<std::uint64_t>(array->bytes)));
  }
  file.commit();
}

}  // namespace

std::string damage_state(const std::filesystem::path& from, const std::filesystem::path& to,
                         std::uint64_t seed) {
  Damage damage(seed);
  std::string what;
  rewrite(from, to, [&](const std::vector<Array*>& contents) {
    Array& changed = *contents[damage.below(contents.size())];
    what = changed.name + ": " + damage.apply(changed);
  });
  return what;
}

void change_state(const std::filesystem::path& from, const std::filesystem::path& to, const std::string& name,
                  const std::function<void(std::span<std::byte>)>& change) {
  rewrite(from, to, [&](const std::vector<Array*>& contents) {
    for (Array* array : contents)
      if (array->name == name) return change(array->bytes);
    throw std::runtime_error("there is no array " + name);
  });
}

}  // namespace tandem::test
