#include "coordinator/mesh_import/mesh_import.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "common/error.hpp"

namespace tandem::launch {
namespace {

namespace fs = std::filesystem;

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    sum += dot(mesh.vertices[i], cross(mesh.vertices[j], mesh.vertices[k])) / 6;
  return sum;
}

class MeshImport : public testing::Test {
 protected:
  MeshImport() : folder_(fs::temp_directory_path() / ("tandem_mesh_import_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~MeshImport() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  fs::path path(const std::string& name) const { return folder_ / name; }

  std::string verdict(const fs::path& file) const {
    try {
      import_mesh(file, 1);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::scene);
      return error.what();
    }
    return "no error";
  }

 private:
  fs::path folder_;
};

std::string ascii_stl(const TriangleMesh& mesh) {
  std::ostringstream text;
  text << "solid box\n";
  for (const auto& triangle : mesh.triangles) {
    text << "facet normal 0 0 0\n outer loop\n";
    for (const auto v : triangle)
      text << "  vertex " << mesh.vertices[v].x << " " << mesh.vertices[v].y << " " << mesh.vertices[v].z
           << "\n";
    text << " endloop\nendfacet\n";
  }
  text << "endsolid box\n";
  return text.str();
}

std::string binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  const auto put = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) put(0.0f);  // normal, which follows from the corners
    for (const auto v : triangle)
      for (int i = 0; i < 3; ++i) put(static_cast<float>(mesh.vertices[v][i]));
    put(std::uint16_t{0});
  }
  return bytes;
}

// A box of 2 x 4 x 6 mm.
void expect_box(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.vertices.size(), 8u) << "corners are joined";
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_NEAR(volume(mesh), 48e-9, 1e-20) << "winding is kept, and lengths are scaled";
}

TEST_F(MeshImport, AsciiStl) {
  expect_box(import_mesh(write("box.stl", ascii_stl(box_mesh({2, 4, 6}))), 1e-3));
}

TEST_F(MeshImport, BinaryStl) {
  expect_box(import_mesh(write("box.STL", binary_stl(box_mesh({2, 4, 6}))), 1e-3));
}

TEST_F(MeshImport, BinaryStlThatBeginsLikeAnAsciiOne) {
  std::string bytes = binary_stl(box_mesh({2, 4, 6}));
  bytes.replace(0, 5, "solid");
  expect_box(import_mesh(write("box.stl", bytes), 1e-3));
}

TEST_F(MeshImport, ObjWithQuads) {
  expect_box(
      import_mesh(write("box.obj",
                        "v -1 -2 -3\nv 1 -2 -3\nv -1 2 -3\nv 1 2 -3\nv -1 -2 3\nv 1 -2 3\nv -1 2 3\nv 1 2 3\n"
                        "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n"),
                  1e-3));
}

TEST_F(MeshImport, ObjOfSeveralParts) {
  const TriangleMesh mesh = import_mesh(write("two.obj",
                                              "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n"
                                              "o a\nf 1 2 3\no b\nf 2 4 3\n"),
                                        1);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.vertices.size(), 4u) << "also across parts";
}

// A scene from somebody else must not make the program read, and repeat in a message, a file of the user.
TEST_F(MeshImport, FilesOfMaterialsAreNotOpened) {
  write("private.mtl", "newmtl a\nKd SECRETWORD 1 1\n");
  const fs::path file =
      write("one.obj", "mtllib private.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(verdict(file), "no error");
  EXPECT_EQ(import_mesh(file, 1).triangles.size(), 1u);
}

TEST_F(MeshImport, CornersAtZeroOfEitherSignAreOne) {
  const TriangleMesh mesh = import_mesh(write("two.obj",
                                              "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 1 -0 -0\nv -0 1 -0\n"
                                              "f 1 2 3\nf 5 4 6\n"),
                                        1);
  EXPECT_EQ(mesh.vertices.size(), 4u);
}

TEST_F(MeshImport, MissingFile) {
  EXPECT_EQ(verdict(path("none.stl")),
            path("none.stl").string() + ": the mesh file does not exist (check the path)");
}

TEST_F(MeshImport, AFolderOrADeviceIsNoMesh) {
  std::filesystem::create_symlink("/dev/zero", path("endless.obj"));
  EXPECT_EQ(verdict(path("endless.obj")),
            path("endless.obj").string() + ": the mesh file is a device (give the path of a file)");
}

// The corners of a circle as one face, in lines of a hundred; longer faces would take minutes.
TEST_F(MeshImport, AFaceOfVeryManyCornersIsRefused) {
  const auto disc = [this](int corners) {
    std::ostringstream text;
    text << "# a disc\n";
    for (int i = 0; i < corners; ++i)
      text << "v " << std::cos(2 * M_PI * i / corners) << ' ' << std::sin(2 * M_PI * i / corners) << " 0\n";
    text << "f";
    for (int i = 1; i <= corners; ++i) text << ' ' << i << (i % 100 == 0 ? " \\\r\n" : "");
    text << '\n';
    return write("disc.obj", text.str());
  };
  EXPECT_EQ(import_mesh(disc(4096), 1).triangles.size(), 4094u);
  EXPECT_EQ(
      verdict(disc(4097)),
      path("disc.obj").string() +
          ": the face of line 4099 has more than 4096 corners (cut it into triangles in the program that "
          "made it)");
  std::string comment = "# f";
  for (int i = 0; i < 5000; ++i) comment += " 1";
  EXPECT_EQ(verdict(write("words.obj", comment + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), "no error");
}

TEST_F(MeshImport, OtherFormat) {
  EXPECT_EQ(
      verdict(write("box.ply", "ply\n")),
      path("box.ply").string() + ": the mesh format '.ply' is not supported (give an .stl or .obj file)");
}

TEST_F(MeshImport, EmptyFile) {
  EXPECT_EQ(verdict(write("empty.stl", "")),
            path("empty.stl").string() + ": the mesh file is empty (copy or export the file once more)");
}

TEST_F(MeshImport, NotAMesh) {
  EXPECT_EQ(verdict(write("noise.stl", "this is no mesh\n")),
            path("noise.stl").string() +
                ": is no STL file: it does not begin with 'solid', as ASCII files do, and is text "
                "(give an STL or OBJ file)");
  EXPECT_EQ(
      verdict(write("short.stl", std::string(40, '\0'))),
      path("short.stl").string() +
          ": is no STL file: it does not begin with 'solid', as ASCII files do, and has 40 bytes, where "
          "binary ones begin with 84 (give an STL or OBJ file)");
}

TEST_F(MeshImport, CutOffBinary) {
  for (const char* begin : {"     ", "solid"}) {
    std::string bytes = binary_stl(box_mesh({1, 1, 1}));
    bytes.replace(0, 5, begin);
    EXPECT_EQ(verdict(write("cut.stl", bytes.substr(0, 84 + 50 * 7 + 13))),
              path("cut.stl").string() +
                  ": the binary STL file is cut off: for the 12 triangles of its header it should have 684 "
                  "bytes, and has 447, enough for 7 (copy or export the file once more)");
  }
}

TEST_F(MeshImport, BinaryWithMoreThanItsHeaderSays) {
  EXPECT_EQ(verdict(write("long.stl", binary_stl(box_mesh({1, 1, 1})) + std::string(50, '\0'))),
            path("long.stl").string() +
                ": the binary STL file has 734 bytes, 50 more than the 12 triangles of its header take "
                "(export the file once more)");
}

TEST_F(MeshImport, CutOffAscii) {
  const std::string text = ascii_stl(box_mesh({2, 4, 6}));
  // In a triangle, between two, and in the second of two solids.
  for (const std::string& cut :
       {text.substr(0, text.size() / 2), text.substr(0, text.rfind("endsolid")), text + text.substr(0, 300)})
    EXPECT_EQ(verdict(write("cut.stl", cut)),
              path("cut.stl").string() + ": the ASCII STL file is cut off: it has " +
                  std::to_string(cut.size()) +
                  " bytes and does not end with 'endsolid' (copy or export the file once more)");
}

TEST_F(MeshImport, TrianglesWithoutArea) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_EQ(verdict(write("bad.stl", binary_stl(mesh))),
            path("bad.stl").string() +
                ": 1 of 13 triangles have no area, the first is number 13 (repair the mesh in the program "
                "that made it, or by tandem mesh repair)");
}

TEST_F(MeshImport, CornerThatIsNoNumber) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.vertices[0].x = std::numeric_limits<double>::quiet_NaN();
  const std::string message = verdict(write("nan.stl", binary_stl(mesh)));
  EXPECT_NE(message, "no error");
}

}  // namespace
}  // namespace tandem::launch
