// Facts of one product: exact mass properties, mesh, and the faces that joints can be recognised by.
#pragma once

#include <TopoDS_Shape.hxx>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

namespace tandem::step {

// Of a product with solids; without solids {"solids": 0}. Writes its mesh, in metres, to `mesh` as STL.
// deviation: largest distance of mesh and surface [m]; absent: 1/1000 of the diagonal of the product.
// Throws Refusal.
nlohmann::json facts_of_product(const TopoDS_Shape& shape, std::optional<double> deviation,
                                const std::filesystem::path& mesh);

}  // namespace tandem::step
