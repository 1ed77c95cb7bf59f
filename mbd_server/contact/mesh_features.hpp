// Features of a body on a triangle mesh. The solid is behind the faces.
//
// A ball (centre, end of an axis, corner) touches the face, edge or corner of the mesh that is nearest to it,
// where no neighbour is nearer; so a concave mesh has several. Two of one smooth surface, whose normals
// differ by at most 25 degrees and whose triangles meet, are one, the nearer. Edges of the body touch edges
// of the mesh that stick out, and corners of the mesh that stick out touch faces of the body.
#pragma once

#include <optional>

#include "mbd_server/contact/features.hpp"

namespace tandem::mbd {

// As find_features(); b is the mesh. For each ball near the mesh there is a `watch`, and the features of the
// ball itself, with on_mesh.
void find_mesh_features(const Model& model, int a, int b, const std::vector<LinkMotion>& links, double reach,
                        double depth, std::vector<ContactFeature>& features);

// Adds the features of the ball of a watch at present, the nearest first. Where the body is behind an open
// mesh, `behind` is the ball on the back of the nearest face (mesh_back.hpp).
void watched_features(const Model& model, const ContactFeature& watch, const std::vector<LinkMotion>& links,
                      double reach, double depth, std::vector<ContactFeature>& features,
                      std::optional<ContactFeature>* behind = nullptr);

}  // namespace tandem::mbd
