#include "launch/import/urdf_file.hpp"

#include <console_bridge/console.h>
#include <tinyxml.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "common/error.hpp"
#include "common/input_file.hpp"
#include "common/utf8.hpp"
#include "launch/import/nesting.hpp"

namespace tandem::launch {
namespace {

constexpr const char* format_page = "wiki.ros.org/urdf/XML describes the format";

// urdfdom reports errors to a global log of console_bridge. This object receives them while it exists.
class Complaints : public console_bridge::OutputHandler {
 public:
  Complaints() {
    console_bridge::useOutputHandler(this);
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_WARN);
  }
  ~Complaints() override { console_bridge::restorePreviousOutputHandler(); }
  Complaints(const Complaints&) = delete;
  Complaints& operator=(const Complaints&) = delete;

  void log(const std::string& sentence, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) sentences.push_back(sentence);
  }

  std::vector<std::string> sentences;  // of one fault, the innermost first
};

// "Could not parse inertial element for Link [arm]" -> "link 'arm'"
std::string element_in(const std::string& sentence) {
  for (std::size_t at = 0; (at = sentence.find_first_of("LlJj", at)) != std::string::npos; ++at)
    for (const std::string kind : {"link", "joint"}) {
      const bool same =
          std::tolower(sentence[at]) == kind[0] && sentence.compare(at + 1, kind.size() - 1, kind, 1) == 0;
      const std::size_t begin = at + kind.size() + 2, end = sentence.find_first_of("]'", begin);
      if (same && end != std::string::npos && sentence[begin - 2] == ' ' &&
          (sentence[begin - 1] == '[' || sentence[begin - 1] == '\''))
        return kind + " '" + shortened(sentence.substr(begin, end - begin)) + "'";
    }
  return {};
}

[[noreturn]] void fail(const std::string& file, const std::vector<std::string>& complaints) {
  std::string element;
  for (const std::string& sentence : complaints)
    if (element.empty()) element = element_in(sentence);
  const std::string problem = complaints.empty() ? "this is no URDF model" : complaints.front();
  fail_on_urdf(file, element, problem, format_page);
}

// The elements of URDF with their children and attributes. Children in `many` may occur more than once.
struct Known {
  std::vector<std::string> children, many, attributes;
};
const std::map<std::string, Known>& known_elements() {
  static const std::map<std::string, Known> known{
      {"robot", {{}, {"link", "joint", "material"}, {"name", "version"}}},
      {"link", {{"inertial"}, {"visual", "collision"}, {"name"}}},
      {"joint",
       {{"origin", "parent", "child", "axis", "dynamics", "limit", "mimic", "safety_controller",
         "calibration"},
        {},
        {"name", "type"}}},
      {"inertial", {{"origin", "mass", "inertia"}, {}, {}}},
      {"collision", {{"origin", "geometry"}, {}, {"name"}}},
      {"visual", {{"origin", "geometry", "material"}, {}, {"name"}}},
      {"geometry", {{"box", "cylinder", "sphere", "mesh"}, {}, {}}},
      {"origin", {{}, {}, {"xyz", "rpy"}}},
      {"mass", {{}, {}, {"value"}}},
      {"inertia", {{}, {}, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}}},
      {"parent", {{}, {}, {"link"}}},
      {"child", {{}, {}, {"link"}}},
      {"axis", {{}, {}, {"xyz"}}},
      {"dynamics", {{}, {}, {"damping", "friction"}}},
      {"limit", {{}, {}, {"lower", "upper", "effort", "velocity"}}},
      {"mimic", {{}, {}, {"joint", "multiplier", "offset"}}},
      {"box", {{}, {}, {"size"}}},
      {"cylinder", {{}, {}, {"radius", "length"}}},
      {"sphere", {{}, {}, {"radius"}}},
      {"mesh", {{}, {}, {"filename", "scale"}}},
  };
  return known;
}

bool holds(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

// "link 'arm'" for a link or joint, `owner` for any element inside one.
std::string owner_of(const TiXmlElement& element, const std::string& owner) {
  const std::string kind = element.ValueStr();
  if (kind != "link" && kind != "joint") return owner;
  const char* name = element.Attribute("name");
  return name == nullptr ? kind : kind + " '" + shortened(name) + "'";
}

// Collects the elements and attributes that are not part of URDF. Where only one element is allowed, urdfdom
// takes the first of two, but only the author knows which one is meant.
void find_unread(const TiXmlElement& element, const std::string& outer, const std::string& file,
                 std::vector<std::string>& unread) {
  const auto entry = known_elements().find(element.ValueStr());
  if (entry == known_elements().end()) return;  // reported as a whole by another sentence
  const Known& known = entry->second;
  const std::string owner = owner_of(element, outer);
  const std::string place = owner.empty() ? "" : owner + ": ";
  for (const TiXmlAttribute* a = element.FirstAttribute(); a != nullptr; a = a->Next())
    if (!holds(known.attributes, a->Name()) && !std::string(a->Name()).starts_with("xmlns"))
      unread.push_back(place + "attribute " + shortened(a->Name()) + "=\"" + shortened(a->Value()) +
                       "\" of <" + element.ValueStr() + "> is no part of URDF");
  std::map<std::string, int> count;
  for (const TiXmlElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    const std::string& name = child->ValueStr();
    const bool single = holds(known.children, name);
    if (!single && !holds(known.many, name)) {
      unread.push_back(place + "<" + shortened(name) + "> is no part of URDF");
      continue;
    }
    if (single && ++count[name] > 1)
      fail_on_urdf(file, owner, "<" + name + "> is given twice", "keep one of them");
    find_unread(*child, owner, file, unread);
  }
}

// TinyXML is recursive, and deep nesting overflows the stack.
void require_shallow(const std::string& text, const std::string& file) {
  constexpr std::size_t deepest = 64;  // far deeper than any model
  const Nesting nesting = nesting_of(text);
  const std::string line = "line " + std::to_string(nesting.line);
  if (nesting.fault != nullptr) fail_on_urdf(file, line, nesting.fault, format_page);
  if (nesting.deepest > deepest)
    fail_on_urdf(file, line,
                 "elements are nested " + std::to_string(nesting.deepest) + " deep; at most " +
                     std::to_string(deepest) + " levels are read",
                 "close each element; a URDF model has 5 levels");
}

// Where several joints have the same child, urdfdom keeps the last one; it also accepts links in a ring that
// is not connected with the root.
void require_tree(const urdf::ModelInterface& model, const std::string& file) {
  std::map<std::string, std::string> joint_of;  // joint by its child
  for (const auto& [name, joint] : model.joints_) {
    const auto [entry, is_new] = joint_of.emplace(joint->child_link_name, name);
    if (!is_new)
      fail_on_urdf(
          file, "joint '" + name + "'",
          "link '" + joint->child_link_name + "' is already the child of joint '" + entry->second + "'",
          "a URDF model is a tree; close the loop in the scene by hand");
  }
  std::set<std::string> carried;
  std::vector<urdf::LinkConstSharedPtr> open{model.getRoot()};
  while (!open.empty()) {
    const urdf::LinkConstSharedPtr link = open.back();
    open.pop_back();
    carried.insert(link->name);
    open.insert(open.end(), link->child_links.begin(), link->child_links.end());
  }
  for (const auto& [name, link] : model.links_)
    if (!carried.contains(name))
      fail_on_urdf(file, "link '" + name + "'",
                   "is carried by joints that form a ring, without an end at the root",
                   "a URDF model is a tree; close the loop in the scene by hand");
}

}  // namespace

void fail_on_urdf(const std::string& file, const std::string& element, const std::string& problem,
                  const std::string& hint) {
  constexpr std::size_t longest = 300;  // sentences of urdfdom repeat names of the file
  throw Error(ErrorCode::scene, shortened(problem, longest),
              element.empty() ? file : file + ": " + shortened(element, longest), hint);
}

UrdfFile read_urdf(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::string text =
      read_input(path, {.largest = largest_text, .hint = "give the path of a URDF file"});
  require_shallow(text, file);
  if (!is_utf8(text))
    fail_on_urdf(file, "", "is not UTF-8, and its names become those of a scene", "save it in that encoding");

  UrdfFile urdf;
  {
    Complaints complaints;
    urdf.model = urdf::parseURDF(text);
    if (!urdf.model || !complaints.sentences.empty()) fail(file, complaints.sentences);
  }
  TiXmlDocument document;
  document.Parse(text.c_str());
  find_unread(*document.FirstChildElement("robot"), "", file, urdf.unread);
  require_tree(*urdf.model, file);
  return urdf;
}

}  // namespace tandem::launch
