#include "tests/fuzz/arrays.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <stdexcept>

namespace tandem::fuzz {
namespace {

// Each array is encoded as: length of the name, kind of number, length of the values, name, values.
struct ArrayHead {
  std::uint8_t name = 0, number = 0;
  std::uint16_t reserved = 0;
  std::uint32_t values = 0;
};

constexpr std::size_t sizes[] = {1, 4, 4, 8, 4, 8};

std::size_t size_of(Number number) {
  return sizes[static_cast<std::size_t>(number)];
}

hid_t type_of(Number number) {
  const hid_t types[] = {H5T_NATIVE_UCHAR,  H5T_NATIVE_UINT32, H5T_NATIVE_INT32,
                         H5T_NATIVE_UINT64, H5T_NATIVE_FLOAT,  H5T_NATIVE_DOUBLE};
  return types[static_cast<std::size_t>(number)];
}

void expect_done(herr_t status, const char* name) {
  if (status < 0) throw std::runtime_error(std::string("HDF5 cannot read ") + name);
}

Array read(hid_t file, const char* name) {
  const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), type = H5Dget_type(set), space = H5Dget_space(set);
  Array array{name, Number::bytes, {}};
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  for (const Number number :
       {Number::bytes, Number::uint32, Number::int32, Number::uint64, Number::float32, Number::float64})
    if (H5Tequal(type, type_of(number)) > 0) array.number = number;
  array.values.resize(count * size_of(array.number));
  if (count > 0)
    expect_done(H5Dread(set, type_of(array.number), H5S_ALL, H5S_ALL, H5P_DEFAULT, array.values.data()),
                name);
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(set);
  return array;
}

// Letters, digits and the other characters of tandem's names.
char plain(std::byte byte) {
  constexpr std::string_view known = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-/ ";
  const char c = static_cast<char>(byte);
  return known.find(c) != known.npos ? c : '_';
}

// A name must be new, and no group may have the name of an array.
bool has_place(const std::set<std::string>& names, const std::string& name) {
  if (name.empty() || name.front() == '/' || name.back() == '/' || name.find("//") != name.npos ||
      name == ".")
    return false;
  return std::ranges::none_of(names, [&](const std::string& other) {
    return other == name || other.starts_with(name + "/") || name.starts_with(other + "/");
  });
}

}  // namespace

std::vector<Array> arrays_of(const std::filesystem::path& path) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) throw std::runtime_error(path.string() + " is no HDF5 file");
  std::vector<std::string> names;
  const auto note = [](hid_t, const char* name, const H5O_info_t* info, void* out) -> herr_t {
    if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(out)->emplace_back(name);
    return 0;
  };
  expect_done(H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, note, &names), path.c_str());
  std::vector<Array> arrays;
  for (const std::string& name : names) arrays.push_back(read(file, name.c_str()));
  H5Fclose(file);
  return arrays;
}

Bytes packed(const std::vector<Array>& arrays) {
  Bytes bytes;
  for (const Array& array : arrays) {
    const ArrayHead head{static_cast<std::uint8_t>(array.name.size()),
                         static_cast<std::uint8_t>(array.number), 0,
                         static_cast<std::uint32_t>(array.values.size())};
    for (const auto part : {std::as_bytes(std::span(&head, 1)), std::as_bytes(std::span(array.name)),
                            std::as_bytes(std::span(array.values))})
      bytes.insert(bytes.end(), part.begin(), part.end());
  }
  return bytes;
}

std::vector<Array> unpacked(std::span<const std::byte> bytes) {
  std::vector<Array> arrays;
  std::set<std::string> names;
  while (bytes.size() >= sizeof(ArrayHead)) {
    ArrayHead head;
    std::memcpy(&head, bytes.data(), sizeof head);
    bytes = bytes.subspan(sizeof head);
    const auto name = bytes.first(std::min<std::size_t>(head.name, bytes.size()));
    bytes = bytes.subspan(name.size());
    const auto values = bytes.first(std::min<std::size_t>(head.values, bytes.size()));
    bytes = bytes.subspan(values.size());
    Array array{{}, static_cast<Number>(head.number % std::size(sizes)), {values.begin(), values.end()}};
    std::ranges::transform(name, std::back_inserter(array.name), plain);
    array.values.resize(array.values.size() / size_of(array.number) * size_of(array.number));
    if (!has_place(names, array.name)) continue;
    names.insert(array.name);
    arrays.push_back(std::move(array));
  }
  return arrays;
}

}  // namespace tandem::fuzz
