// Reads a URDF file by urdfdom, and reports the elements that urdfdom ignores because it does not know them.
#pragma once

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace tandem::launch {

struct UrdfFile {
  urdf::ModelInterfaceSharedPtr model;
  std::vector<std::string> unread;  // sentences about elements and attributes that are not part of URDF
};

// Every complaint of urdfdom becomes an Error{scene} that names the link or joint, also where urdfdom itself
// would continue without the element.
UrdfFile read_urdf(const std::filesystem::path& path);

// Throws Error{scene} about `element` of the file, such as "link 'arm'"; empty: about the file.
[[noreturn]] void fail_on_urdf(const std::string& file, const std::string& element,
                               const std::string& problem, const std::string& hint);

}  // namespace tandem::launch
