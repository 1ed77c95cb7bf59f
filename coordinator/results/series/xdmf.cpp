#include "coordinator/results/series/xdmf.hpp"

#include <fmt/format.h>

#include "common/file_draft.hpp"

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

std::string data_item(const DatasetInfo& array) {
  const bool real = array.number == Number::float64 || array.number == Number::float32;
  const char* type = real ? "Float" : (array.number == Number::uint32 ? "UInt" : "Int");
  const int precision = array.number == Number::float64 ? 8 : 4;
  const std::string extent =
      array.columns == 1 ? fmt::format("{}", array.rows) : fmt::format("{} {}", array.rows, array.columns);
  return fmt::format(
      R"(<DataItem Format="HDF" NumberType="{}" Precision="{}" Dimensions="{}">{}:{}</DataItem>)", type,
      precision, extent, array.file, array.path);
}

std::string uniform_grid(const XdmfGrid& grid, const std::string& time) {
  std::string xml = fmt::format("<Grid Name=\"{}\" GridType=\"Uniform\">{}\n", escaped(grid.name), time);
  // Points need a list too: without it the newer of ParaView's two readers makes no cells and draws
  // nothing.
  xml += fmt::format("  <Topology TopologyType=\"{}\" NumberOfElements=\"{}\">{}</Topology>\n",
                     grid.cells.columns == 3 ? "Triangle" : "Polyvertex", grid.cells.rows,
                     data_item(grid.cells));
  xml += fmt::format("  <Geometry GeometryType=\"XYZ\">{}</Geometry>\n", data_item(grid.points));
  for (const XdmfAttribute& attribute : grid.attributes) {
    xml += fmt::format("  <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n",
                       escaped(attribute.name), attribute.array.columns == 3 ? "Vector" : "Scalar",
                       attribute.center == Center::node ? "Node" : "Cell", data_item(attribute.array));
  }
  return xml + "</Grid>\n";
}

}  // namespace

XdmfSeries::XdmfSeries(std::filesystem::path file) : file_(std::move(file)) {}

void XdmfSeries::append(double time, const std::vector<XdmfGrid>& grids) {
  const std::string time_xml = fmt::format("<Time Value=\"{}\"/>", time);
  if (grids.size() == 1) {
    steps_ += uniform_grid(grids.front(), time_xml);
  } else {
    steps_ +=
        fmt::format("<Grid Name=\"step\" GridType=\"Collection\" CollectionType=\"Spatial\">{}\n", time_xml);
    for (const XdmfGrid& grid : grids) steps_ += uniform_grid(grid, "");
    steps_ += "</Grid>\n";
  }
}

void XdmfSeries::write() {
  FileDraft draft(file_);
  std::string begin;
  if (without_end_ == 0)
    begin = fmt::format(
        "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n"
        "<Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n",
        file_.stem().string());
  else
    draft.append_from(file_, without_end_);
  draft.append(begin);
  draft.append(steps_);
  draft.append("</Grid>\n</Domain>\n</Xdmf>\n");
  draft.commit();
  without_end_ += begin.size() + steps_.size();
  steps_.clear();
}

}  // namespace tandem::launch
