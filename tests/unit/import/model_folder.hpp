// A temporary folder with a URDF model, and helpers to write one.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "common/error.hpp"
#include "launch/import/import.hpp"

namespace tandem::launch {

inline const std::string unit_inertial =
    R"(<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>)";

inline std::string link(const std::string& name, const std::string& inside = unit_inertial) {
  return "<link name=\"" + name + "\">" + inside + "</link>";
}
// From link a to link b.
inline std::string joint(const std::string& type, const std::string& inside = "") {
  return "<joint name=\"j\" type=\"" + type + R"("><parent link="a"/><child link="b"/>)" + inside +
         "</joint>";
}

class ModelFolder : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void put(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  Imported import(const std::string& elements, ImportOptions options = {}) const {
    put("m.urdf", "<robot name=\"m\">" + elements + "</robot>");
    options.model = folder_ / "m.urdf";
    if (options.output.empty()) options.output = folder_ / "m.json";
    return import_urdf(options);
  }
  // The message of the error, without the folder.
  std::string refusal(const std::string& elements, const ImportOptions& options = {}) const {
    try {
      import(elements, options);
    } catch (const Error& error) {
      std::string text = error.what();
      const std::string path = folder_.string() + "/";
      for (std::size_t at; (at = text.find(path)) != std::string::npos;) text.erase(at, path.size());
      return text;
    }
    return "imported";
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("tandem_import_" + std::to_string(getpid()));
};

}  // namespace tandem::launch
