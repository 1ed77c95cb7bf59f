#include "launch/results/series/xdmf.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <system_error>

#include "launch/results/disk_error.hpp"

namespace tandem::launch {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string data_item(const DatasetInfo& array, const std::string& file) {
  const bool real = array.number == Number::float64 || array.number == Number::float32;
  const char* type = real ? "Float" : (array.number == Number::uint32 ? "UInt" : "Int");
  const int precision = array.number == Number::float64 ? 8 : 4;
  const std::string extent =
      array.columns == 1 ? fmt::format("{}", array.rows) : fmt::format("{} {}", array.rows, array.columns);
  return fmt::format(
      R"(<DataItem Format="HDF" NumberType="{}" Precision="{}" Dimensions="{}">{}:{}</DataItem>)", type,
      precision, extent, file, array.path);
}

std::string uniform_grid(const XdmfGrid& grid, const std::string& file, const std::string& time) {
  std::string xml = fmt::format("<Grid Name=\"{}\" GridType=\"Uniform\">{}\n", escaped(grid.name), time);
  // Points are listed too: without a list the newer of ParaView's two readers makes no cells, and draws none.
  xml += fmt::format("  <Topology TopologyType=\"{}\" NumberOfElements=\"{}\">{}</Topology>\n",
                     grid.cells.columns == 3 ? "Triangle" : "Polyvertex", grid.cells.rows,
                     data_item(grid.cells, file));
  xml += fmt::format("  <Geometry GeometryType=\"XYZ\">{}</Geometry>\n", data_item(grid.points, file));
  for (const XdmfAttribute& attribute : grid.attributes) {
    xml += fmt::format("  <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n",
                       escaped(attribute.name), attribute.array.columns == 3 ? "Vector" : "Scalar",
                       attribute.center == Center::node ? "Node" : "Cell", data_item(attribute.array, file));
  }
  return xml + "</Grid>\n";
}

}  // namespace

XdmfSeries::XdmfSeries(std::filesystem::path file, std::string hdf5_name)
    : file_(std::move(file)), hdf5_name_(std::move(hdf5_name)) {}

void XdmfSeries::append(double time, const std::vector<XdmfGrid>& grids) {
  const std::string time_xml = fmt::format("<Time Value=\"{}\"/>", time);
  if (grids.size() == 1) {
    steps_ += uniform_grid(grids.front(), hdf5_name_, time_xml);
  } else {
    steps_ +=
        fmt::format("<Grid Name=\"step\" GridType=\"Collection\" CollectionType=\"Spatial\">{}\n", time_xml);
    for (const XdmfGrid& grid : grids) steps_ += uniform_grid(grid, hdf5_name_, "");
    steps_ += "</Grid>\n";
  }

  const std::filesystem::path draft = file_.string() + ".new";
  {
    std::ofstream out(draft);
    out << "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n"
        << "<Grid Name=\"" << file_.stem().string()
        << "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n"
        << steps_ << "</Grid>\n</Domain>\n</Xdmf>\n";
    out.close();
    if (!out) fail_on_disk(draft, "cannot write: " + std::generic_category().message(errno));
  }
  std::error_code failure;
  std::filesystem::rename(draft, file_, failure);
  if (failure) fail_on_disk(file_, "cannot replace: " + failure.message());
}

}  // namespace tandem::launch
