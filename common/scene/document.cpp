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

// Tracks the position of the parser, for faults that the library reports without one.
class Tracker {
 public:
  explicit Tracker(const std::string& origin) : origin_(origin) {}

  void see(json::parse_event_t event, json& parsed) {
    using Event = json::parse_event_t;
    switch (event) {
      case Event::object_start:
        open_.push_back({.is_array = false, .index = 0, .key = {}, .keys = {}});
        break;
      case Event::array_start:
        open_.push_back({.is_array = true, .index = 0, .key = {}, .keys = {}});
        break;
      case Event::key:
        see_key(parsed.get_ref<const std::string&>());
        break;
      case Event::object_end:
      case Event::array_end:
        open_.pop_back();
        next_element();
        break;
      case Event::value:
        // Refused like larger numbers: valijson treats those beyond int64 as negative.
        if (parsed.is_number_unsigned() && parsed.get<std::uint64_t>() > largest_int64)
          parsed = parsed.get<double>();
        next_element();
        break;
    }
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

  void see_key(const std::string& key) {
    Container& object = open_.back();
    object.key = key;
    if (!object.keys.insert(key).second)
      fail(origin_, path(), "the key '" + shortened(key) + "' is given twice", "keep one of them");
  }

  void next_element() {
    if (!open_.empty() && open_.back().is_array) ++open_.back().index;
  }

  const std::string& origin_;
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
  Tracker tracker(origin);
  try {
    return json::parse(text, [&](int depth, json::parse_event_t event, json& parsed) {
      // Far deeper than any scene, and shallow enough for recursive functions.
      constexpr int deepest = 64;
      if (depth > deepest)
        fail(origin, "", "lists and objects are nested more than " + std::to_string(deepest) + " deep",
             "a scene needs fewer than 10 levels");
      tracker.see(event, parsed);
      return true;
    });
  } catch (const json::parse_error& error) {
    fail_at_syntax(origin, error.what());
  } catch (const json::out_of_range&) {
    fail(origin, tracker.path(), "the number is too large", "give a finite number below 1.8e308");
  }
}

}  // namespace tandem::scene
