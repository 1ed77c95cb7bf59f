#include "common/scene/particle_file.hpp"

#include <gtest/gtest.h>

#include "common/error.hpp"

namespace tandem::scene {
namespace {

std::string verdict(const std::string& text) {
  try {
    read_particle_file(text, "p.csv");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ParticleFile, PositionsOnly) {
  const ParticleFile file = read_particle_file("x,y,z\n1,2,3\n-4e-1,5,6\n", "p.csv");
  ASSERT_EQ(file.positions.size(), 2u);
  EXPECT_EQ(file.positions[1], (Vec3d{-0.4, 5, 6}));
  EXPECT_TRUE(file.radii.empty());
  EXPECT_TRUE(file.velocities.empty());
}

TEST(ParticleFile, AllColumnsInAnyOrderWithBlanksAndCarriageReturns) {
  const ParticleFile file =
      read_particle_file("vx, vy, vz, radius, z, y, x\r\n1, 2, 3, 0.5, 6, 5, 4\r\n\r\n", "p.csv");
  ASSERT_EQ(file.positions.size(), 1u);
  EXPECT_EQ(file.positions[0], (Vec3d{4, 5, 6}));
  EXPECT_EQ(file.radii[0], 0.5);
  EXPECT_EQ(file.velocities[0], (Vec3d{1, 2, 3}));
}

TEST(ParticleFile, AByteOrderMarkIsSkipped) {
  const ParticleFile file = read_particle_file("\xEF\xBB\xBFx,y,z\r\n1,2,3\r\n", "p.csv");
  ASSERT_EQ(file.positions.size(), 1u);
  EXPECT_EQ(file.positions[0], (Vec3d{1, 2, 3}));
  EXPECT_EQ(verdict("\xEF\xBB\xBF"),
            "p.csv: the file holds no sphere (a header x,y,z and one line per sphere)");
}

TEST(ParticleFile, EveryFaultNamesItsLine) {
  EXPECT_EQ(verdict("x,y,z\n1,2\n"), "p.csv: line 2: the line has 2 fields (the header has 3)");
  EXPECT_EQ(verdict("x,y,z\n1,2,3\n1,2,3m\n"),
            "p.csv: line 3: '3m' is not a finite number (give plain decimal numbers between commas)");
  EXPECT_EQ(verdict("x,y,z\n1,2,nan\n"),
            "p.csv: line 2: 'nan' is not a finite number (give plain decimal numbers between commas)");
  EXPECT_EQ(verdict("x,y,z\n1,2,1e999\n"),
            "p.csv: line 2: '1e999' is not a finite number (give plain decimal numbers between commas)");
  EXPECT_EQ(verdict("x,y,z,radius\n1,2,3,0\n"), "p.csv: line 2: the radius is 0 (give a radius > 0 [m])");
}

TEST(ParticleFile, EveryFaultOfTheHeader) {
  EXPECT_EQ(verdict("x,y,z,radios\n1,2,3,4\n"),
            "p.csv: line 1: unknown column 'radios' (did you mean 'radius'?)");
  EXPECT_EQ(verdict("x,y\n1,2\n"),
            "p.csv: line 1: the column 'z' is missing (the header is x,y,z[,radius][,vx,vy,vz][,wx,wy,wz])");
  EXPECT_EQ(verdict("x,y,z,vy\n1,2,3,4\n"),
            "p.csv: line 1: the column 'vx' is missing (the header is x,y,z[,radius][,vx,vy,vz][,wx,wy,wz])");
  EXPECT_EQ(verdict("x,y,z,x\n1,2,3,4\n"), "p.csv: line 1: the column 'x' is given twice (keep one of them)");
  EXPECT_EQ(verdict("1,2,3\n"),
            "p.csv: line 1: unknown column '1' (known columns: x, y, z, radius, vx, vy, vz, wx, wy, wz)");
}

TEST(ParticleFile, NoSphere) {
  EXPECT_EQ(verdict(""), "p.csv: the file holds no sphere (a header x,y,z and one line per sphere)");
  EXPECT_EQ(verdict("x,y,z\n"), "p.csv: the file holds no sphere (a header x,y,z and one line per sphere)");
}

}  // namespace
}  // namespace tandem::scene
