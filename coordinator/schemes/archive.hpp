// Saves members of an object to a state file and restores them: an object lists its state once, in its
// save_or_restore(), for both directions.
#pragma once

#include <Eigen/Core>
#include <cstring>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "common/error.hpp"
#include "common/state_file.hpp"
#include "protocol/checks.hpp"
#include "protocol/codec.hpp"

namespace tandem::launch {

class Archive {
 public:
  explicit Archive(StateWriter& out) : out_(&out) {}
  explicit Archive(const StateReader& in) : in_(&in) {}

  bool reads() const { return in_ != nullptr; }

  void operator()(const std::string& name, double& value);
  void operator()(const std::string& name, std::uint64_t& value);
  void operator()(const std::string& name, std::vector<double>& values);
  void operator()(const std::string& name, Eigen::VectorXd& values);
  void operator()(const std::string& name, std::string& text);
  void operator()(const std::string& name, std::vector<std::string>& lines);  // without line breaks
  void operator()(const std::string& name, protocol::MotionSet& value) { payload(name, value); }
  void operator()(const std::string& name, protocol::LoadSet& value) { payload(name, value); }
  void operator()(const std::string& name, protocol::TangentSet& value) { payload(name, value); }

  // Throws Error{resource} where no run can have left the value that was read.
  void expect(bool sound, const std::string& name, const std::string& problem) const;

  // One byte in a file; values other than 0 and 1 are refused.
  void operator()(const std::string& name, bool& value);
  // A record, copied byte by byte.
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void operator()(const std::string& name, T& value) {
    protocol::Bytes raw(sizeof(T));
    std::memcpy(raw.data(), &value, sizeof(T));
    bytes(name, raw);
    if (raw.size() != sizeof(T)) fail(name);
    std::memcpy(&value, raw.data(), sizeof(T));
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void operator()(const std::string& name, std::vector<T>& values) {
    protocol::Bytes raw(values.size() * sizeof(T));
    if (!raw.empty()) std::memcpy(raw.data(), values.data(), raw.size());
    bytes(name, raw);
    if (raw.size() % sizeof(T) != 0) fail(name);
    values.resize(raw.size() / sizeof(T));
    if (!raw.empty()) std::memcpy(values.data(), raw.data(), raw.size());
  }
  template <class T>
  void operator()(const std::string& name, std::map<std::uint32_t, T>& values) {
    std::vector<std::uint32_t> keys;
    std::vector<T> items;
    for (const auto& [key, item] : values) keys.push_back(key), items.push_back(item);
    (*this)(name + ".keys", keys);
    (*this)(name + ".items", items);
    if (keys.size() != items.size()) fail(name);
    values.clear();
    for (std::size_t i = 0; i < keys.size(); ++i) values[keys[i]] = items[i];
  }

 private:
  template <class T>
  void payload(const std::string& name, T& value) {
    protocol::Bytes raw;
    if (out_) protocol::encode(raw, value);
    bytes(name, raw);
    if (out_) return;
    try {
      protocol::decode(raw, value);
      protocol::check_values(value);
    } catch (const Error& error) {
      expect(false, name, error.problem());
    }
  }
  void bytes(const std::string& name, protocol::Bytes& raw);
  [[noreturn]] void fail(const std::string& name) const;

  StateWriter* out_ = nullptr;
  const StateReader* in_ = nullptr;
};

}  // namespace tandem::launch
