// A value of the document together with its path, for the position of a fault. The schema has been checked
// before: a key that is present has the right type.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/math/rotation.hpp"

namespace tandem::scene {

// Names of a list, which differ from each other, by index and the other way around.
class Names {
 public:
  // Returns false where the name is there already.
  bool add(const std::string& name) {
    const bool is_new = index_.emplace(name, static_cast<std::uint32_t>(list_.size())).second;
    if (is_new) list_.push_back(name);
    return is_new;
  }
  std::optional<std::uint32_t> index(const std::string& name) const {
    const auto found = index_.find(name);
    return found == index_.end() ? std::nullopt : std::optional(found->second);
  }
  const std::vector<std::string>& list() const { return list_; }

 private:
  std::vector<std::string> list_;
  std::unordered_map<std::string, std::uint32_t> index_;
};

class Node {
 public:
  Node(const nlohmann::json& value, std::string path, const std::string& origin)
      : value_(value), path_(std::move(path)), origin_(origin) {}

  bool has(const char* key) const { return value_.contains(key); }
  Node at(const char* key) const;
  std::vector<Node> elements(const char* key) const;  // of a list; empty where the key is absent
  const nlohmann::json& value() const { return value_; }
  const std::string& path() const { return path_; }

  // Reads `key` where it is present; otherwise `target` keeps the default of the model.
  template <class T>
  void read(const char* key, T& target) const {
    if (has(key)) value_.at(key).get_to(target);
  }
  template <class T>
  void read(const char* key, std::optional<T>& target) const {
    if (has(key)) target = value_.at(key).get<T>();
  }
  void read(const char* key, Vec3d& target) const;
  void read(const char* key, Quat& target) const;
  // Reads a direction. A length within 1e-6 of 1, as rounded decimals have, becomes 1; validate() refuses
  // any other.
  void read_unit(const char* key, Vec3d& target) const;

  // The names of the elements of a list, which must differ from each other and from those in `reserved`.
  Names names(const char* key, const std::vector<std::string>& reserved = {}) const;

  std::string type() const { return value_.at("type").get<std::string>(); }

  // Index of the name under `key` in `names`; an unknown name is an error. `kind` is the plural noun of the
  // names.
  std::uint32_t resolve(const char* key, const Names& names, const char* kind) const;

  [[noreturn]] void fail(const std::string& problem, const std::string& hint) const;  // about this value
  [[noreturn]] void fail(const char* key, const std::string& problem, const std::string& hint) const;

 private:
  const nlohmann::json& value_;
  std::string path_;
  const std::string& origin_;
};

}  // namespace tandem::scene
