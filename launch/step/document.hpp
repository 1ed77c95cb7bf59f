// The tree of a STEP file: assemblies, parts and the distinct shapes that the parts are instances of.
#pragma once

#include <TopoDS_Shape.hxx>
#include <gp_Trsf.hxx>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tandem::step {

// OpenCASCADE computes in millimetres, which its tolerances are made for.
inline constexpr double metres = 1e-3;

// Shape of a product, in its own frame [mm]; all its instances refer to it.
struct Product {
  std::string name;
  TopoDS_Shape shape;
};

struct Document {
  std::vector<Product> products;
  std::string unit;  // of lengths, as the file says it
  nlohmann::json
      tree;  // {name, children} of assemblies, {name, product, position, orientation, ...} of parts
};

// Throws Refusal.
Document read_document(const std::string& file);

}  // namespace tandem::step
