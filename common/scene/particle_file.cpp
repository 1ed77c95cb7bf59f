#include "common/scene/particle_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "common/scene/fault.hpp"
#include "common/scene/nearest_name.hpp"
#include "common/utf8.hpp"

namespace tandem::scene {

namespace {

const std::vector<std::string> known_columns{"x", "y", "z", "radius", "vx", "vy", "vz", "wx", "wy", "wz"};
constexpr std::size_t radius_column = 3, velocity_column = 4, spin_column = 7;

std::string_view trimmed(std::string_view field) {
  const auto first = field.find_first_not_of(" \t");
  if (first == field.npos) return {};
  return field.substr(first, field.find_last_not_of(" \t") - first + 1);
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    fields.push_back(trimmed(line.substr(begin, comma - begin)));
    if (comma == line.npos) return fields;
    begin = comma + 1;
  }
}

// Index of each known column in the lines of the file, or `absent`.
constexpr std::size_t absent = static_cast<std::size_t>(-1);
using Header = std::array<std::size_t, 10>;

Header read_header(const std::vector<std::string_view>& fields, const std::string& origin) {
  Header header;
  header.fill(absent);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto known = std::find(known_columns.begin(), known_columns.end(), fields[i]);
    if (known == known_columns.end())
      fail(origin, "line 1", "unknown column '" + shortened(fields[i]) + "'",
           suggest_name(fields[i], known_columns, "columns"));
    std::size_t& place = header[static_cast<std::size_t>(known - known_columns.begin())];
    if (place != absent)
      fail(origin, "line 1", "the column '" + *known + "' is given twice", "keep one of them");
    place = i;
  }
  const auto any_of = [&](std::size_t first) {
    return std::any_of(header.begin() + first, header.begin() + first + 3,
                       [](std::size_t place) { return place != absent; });
  };
  const bool any_velocity = any_of(velocity_column), any_spin = any_of(spin_column);
  for (std::size_t column = 0; column < header.size(); ++column) {
    const bool needed = column < radius_column ||
                        (column >= velocity_column && column < spin_column && any_velocity) ||
                        (column >= spin_column && any_spin);
    if (needed && header[column] == absent)
      fail(origin, "line 1", "the column '" + known_columns[column] + "' is missing",
           "the header is x,y,z[,radius][,vx,vy,vz][,wx,wy,wz]");
  }
  return header;
}

double read_number(std::string_view field, const std::string& origin, std::size_t line) {
  double number = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
  if (error != std::errc() || end != field.data() + field.size() || !std::isfinite(number))
    fail(origin, "line " + std::to_string(line), "'" + shortened(field) + "' is not a finite number",
         "give plain decimal numbers between commas");
  return number;
}

}  // namespace

ParticleFile read_particle_file(const std::string& text, const std::string& origin) {
  ParticleFile file;
  Header header{};
  std::size_t width = 0, number_of_line = 0;
  // Spreadsheets write a byte order mark before the first column.
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  for (std::size_t begin = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
       begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    ++number_of_line;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (number_of_line > 1 && trimmed(line).empty()) continue;

    const auto fields = split(line);
    if (number_of_line == 1) {
      header = read_header(fields, origin);
      width = fields.size();
      continue;
    }
    const std::string where = "line " + std::to_string(number_of_line);
    if (fields.size() != width)
      fail(origin, where, "the line has " + std::to_string(fields.size()) + " fields",
           "the header has " + std::to_string(width));
    const auto number = [&](std::size_t column) {
      return read_number(fields[header[column]], origin, number_of_line);
    };
    file.positions.push_back({number(0), number(1), number(2)});
    if (header[radius_column] != absent) {
      file.radii.push_back(number(radius_column));
      if (!(file.radii.back() > 0))
        fail(origin, where, "the radius is " + tandem::scene::text(file.radii.back()),
             "give a radius > 0 [m]");
    }
    if (header[velocity_column] != absent)
      file.velocities.push_back(
          {number(velocity_column), number(velocity_column + 1), number(velocity_column + 2)});
    if (header[spin_column] != absent)
      file.spins.push_back({number(spin_column), number(spin_column + 1), number(spin_column + 2)});
  }
  if (file.positions.empty())
    fail(origin, "", "the file holds no sphere", "a header x,y,z and one line per sphere");
  return file;
}

std::string particle_file_text(const ParticleFile& file) {
  const bool radii = !file.radii.empty(), velocities = !file.velocities.empty(), spins = !file.spins.empty();
  std::string all = "x,y,z";
  if (radii) all += ",radius";
  if (velocities) all += ",vx,vy,vz";
  if (spins) all += ",wx,wy,wz";
  const auto add = [&all](double value, char before) {
    char digits[32];
    const auto end = std::to_chars(std::begin(digits), std::end(digits), value).ptr;
    all += before;
    all.append(digits, end);
  };
  const auto add_vector = [&](Vec3d v, char before) {
    add(v.x, before);
    add(v.y, ',');
    add(v.z, ',');
  };
  for (std::size_t i = 0; i < file.positions.size(); ++i) {
    add_vector(file.positions[i], '\n');
    if (radii) add(file.radii[i], ',');
    if (velocities) add_vector(file.velocities[i], ',');
    if (spins) add_vector(file.spins[i], ',');
  }
  all += '\n';
  return all;
}

}  // namespace tandem::scene
