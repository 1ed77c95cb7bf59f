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
  // What OpenCASCADE could not make of the file: a part may lack a face, or be missing.
  std::size_t faults = 0;
  std::string first_fault;
  // {name, children} of assemblies, {name, product, position, orientation, ...} of parts.
  nlohmann::json tree;
};

// Throws Refusal.
Document read_document(const std::string& file);

}  // namespace tandem::step
