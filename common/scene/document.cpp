#include "common/scene/document.hpp"

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "common/scene/fault.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {

namespace {

using nlohmann::json;

constexpr std::uint64_t largest_int64 = std::numeric_limits<std::int64_t>::max();

// Builds the document from the events of the parser, and tracks their position for faults that the library
// reports without one. The library's own parser with a callback takes a time that grows with the square of a
// list's length.
class Builder {
 public:
  Builder(const std::string& origin, json& document) : origin_(origin), dom_(document) {}

  bool null() { return dom_.null() && next_element(); }
  bool boolean(bool value) { return dom_.boolean(value) && next_element(); }
  bool number_integer(json::number_integer_t value) { return dom_.number_integer(value) && next_element(); }
  bool number_unsigned(json::number_unsigned_t value) {
    // Refused like larger numbers: valijson treats those beyond int64 as negative.
    return (value > largest_int64 ? dom_.number_float(static_cast<double>(value), {})
                                  : dom_.number_unsigned(value)) &&
           next_element();
  }
  bool number_float(json::number_float_t value, const std::string& text) {
    return dom_.number_float(value, text) && next_element();
  }
  bool string(std::string& value) { return dom_.string(value) && next_element(); }
  bool binary(json::binary_t& value) { return dom_.binary(value) && next_element(); }
  bool start_object(std::size_t size) {
    open(false);
    return dom_.start_object(size);
  }
  bool start_array(std::size_t size) {
    open(true);
    return dom_.start_array(size);
  }
  bool end_object() { return close() && dom_.end_object(); }
  bool end_array() { return close() && dom_.end_array(); }
  bool key(std::string& key) {
    see_key(key);
    return dom_.key(key);
  }
  template <class Exception>
  bool parse_error(std::size_t, const std::string&, const Exception& error) {
    throw error;
  }

  std::string path() const {
    std::string path;
    for (const Container& container : open_) {
      if (container.is_array)
        path = element(path, container.index);
      else if (!container.key.empty())
        path += (path.empty() ? "" : ".") + shortened(container.key);
    }
    return path;
  }

 private:
  struct Container {
    bool is_array;
    std::size_t index;
    std::string key;
    std::set<std::string> keys;
  };

  void open(bool is_array) {
    // Far deeper than any scene, and shallow enough for recursive functions.
    constexpr std::size_t deepest = 64;
    if (open_.size() > deepest)
      fail(origin_, "", "lists and objects are nested more than " + std::to_string(deepest) + " deep",
           "a scene needs fewer than 10 levels");
    open_.push_back({.is_array = is_array, .index = 0, .key = {}, .keys = {}});
  }
  bool close() {
    open_.pop_back();
    return next_element();
  }

  void see_key(const std::string& key) {
    Container& object = open_.back();
    object.key = key;
    if (!object.keys.insert(key).second)
      fail(origin_, path(), "the key '" + shortened(key) + "' is given twice", "keep one of them");
  }

  bool next_element() {
    if (!open_.empty() && open_.back().is_array) ++open_.back().index;
    return true;
  }

  const std::string& origin_;
  nlohmann::detail::json_sax_dom_parser<json> dom_;
  std::vector<Container> open_;
};

// "[json.exception.parse_error.101] parse error at line 2, column 5: syntax error while ..." -> position and
// reason.
[[noreturn]] void fail_at_syntax(const std::string& origin, const std::string& message) {
  const std::size_t at = message.find(" at ");
  const std::size_t colon = message.find(": ", at);
  fail(origin, message.substr(at + 4, colon - at - 4), shortened(message.substr(colon + 2), 300),
       "the file must be one JSON object, without comments or trailing commas");
}

}  // namespace

json read_document(const std::string& text, const std::string& origin) {
  json document;
  Builder builder(origin, document);
  try {
    json::sax_parse(text, &builder);
    return document;
  } catch (const json::parse_error& error) {
    fail_at_syntax(origin, error.what());
  } catch (const json::out_of_range&) {
    fail(origin, builder.path(), "the number is too large", "give a finite number below 1.8e308");
  }
}

}  // namespace tandem::scene
