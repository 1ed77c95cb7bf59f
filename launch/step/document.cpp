#include "launch/step/document.hpp"

#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TDataStd_TreeNode.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFDoc.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <cmath>
#include <gp_Quaternion.hxx>
#include <map>

#include "launch/step/refusal.hpp"

namespace tandem::step {
namespace {

using Json = nlohmann::json;

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  return TCollection_AsciiString(name->Get()).ToCString();  // UTF-8
}

// Names that a program gave because nobody else did: numbers of usages, and labels of OpenCASCADE.
bool is_automatic(const std::string& name) {
  return name.find_first_not_of("0123456789") == std::string::npos || name.starts_with("NAUO") ||
         name.starts_with("=>");
}

class Reader {
 public:
  explicit Reader(const TDF_Label& main)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(main)),
        colours_(XCAFDoc_DocumentTool::ColorTool(main)),
        materials_(XCAFDoc_DocumentTool::MaterialTool(main)) {}

  Document read() {
    TDF_LabelSequence free;
    shapes_->GetFreeShapes(free);
    Json roots = Json::array();
    for (const TDF_Label& label : free) roots.push_back(node(label, gp_Trsf(), 0));
    document_.tree = roots.size() == 1 ? roots[0] : Json{{"name", ""}, {"children", roots}};
    return std::move(document_);
  }

 private:
  // `instance` is a product itself, or a component that refers to one.
  Json node(const TDF_Label& instance, const gp_Trsf& parent, int depth) {
    if (depth > 64) throw Refusal("has assemblies nested more than 64 deep", "export a flatter assembly");
    TDF_Label product = instance;
    if (XCAFDoc_ShapeTool::IsReference(instance)) XCAFDoc_ShapeTool::GetReferredShape(instance, product);
    const gp_Trsf pose = parent * XCAFDoc_ShapeTool::GetLocation(instance).Transformation();
    const std::string own = name_of(instance);
    Json json{{"name", is_automatic(own) ? name_of(product) : own}};
    if (XCAFDoc_ShapeTool::IsAssembly(product)) {
      Json& children = json["children"] = Json::array();
      TDF_LabelSequence components;
      XCAFDoc_ShapeTool::GetComponents(product, components);
      for (const TDF_Label& component : components) children.push_back(node(component, pose, depth + 1));
      return json;
    }
    json["product"] = number_of(product);
    add_pose(pose, json);
    add_colour(instance, product, json);
    add_material(product, json);
    return json;
  }

  std::size_t number_of(const TDF_Label& product) {
    TCollection_AsciiString entry;
    TDF_Tool::Entry(product, entry);
    const auto [found, is_new] = numbers_.try_emplace(entry.ToCString(), document_.products.size());
    if (is_new) {
      // The location of a free shape is part of its pose.
      const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(product).Located(TopLoc_Location());
      document_.products.push_back({name_of(product), shape});
    }
    return found->second;
  }

  void add_pose(const gp_Trsf& pose, Json& json) const {
    if (pose.IsNegative() || std::abs(pose.ScaleFactor() - 1) > 1e-9)
      throw Refusal("places the part '" + json["name"].get<std::string>() + "' mirrored or scaled",
                    "export it as a part of its own");
    const gp_XYZ p = pose.TranslationPart() * metres;
    const gp_Quaternion q = pose.GetRotation();
    json["position"] = {p.X(), p.Y(), p.Z()};
    json["orientation"] = {q.W(), q.X(), q.Y(), q.Z()};
  }

  void add_colour(const TDF_Label& instance, const TDF_Label& product, Json& json) const {
    Quantity_Color colour;
    for (const TDF_Label& label : {instance, product})
      for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
        if (colours_->GetColor(label, type, colour)) {
          Standard_Real r = 0, g = 0, b = 0;
          colour.Values(r, g, b, Quantity_TOC_sRGB);
          json["colour"] = {r, g, b};
          return;
        }
  }

  void add_material(const TDF_Label& product, Json& json) const {
    Handle(TDataStd_TreeNode) node;
    if (!product.FindAttribute(XCAFDoc::MaterialRefGUID(), node) || !node->HasFather()) return;
    Handle(TCollection_HAsciiString) name, description, density_name, density_type;
    Standard_Real density = 0;
    if (materials_->GetMaterial(node->Father()->Label(), name, description, density, density_name,
                                density_type) &&
        !name.IsNull())
      json["material"] = name->ToCString();
  }

  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colours_;
  Handle(XCAFDoc_MaterialTool) materials_;
  std::map<std::string, std::size_t> numbers_;
  Document document_;
};

// Failures of reading or of making shapes; warnings are common and harmless.
void count_faults(const Interface_CheckIterator& checks, Document& document) {
  Interface_CheckIterator each = checks;
  for (each.Start(); each.More(); each.Next()) {
    const Handle(Interface_Check)& check = each.Value();
    if (check.IsNull() || check->NbFails() == 0) continue;
    if (document.faults++ == 0) document.first_fault = check->CFail(1);
  }
}

}  // namespace

Document read_document(const std::string& file) {
  STEPCAFControl_Reader reader;
  reader.SetNameMode(true);
  reader.SetColorMode(true);
  reader.SetMatMode(true);
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone)
    throw Refusal("is no STEP file that OpenCASCADE can read: it is damaged or cut off",
                  "export it again, as AP203, AP214 or AP242");
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  if (reader.ChangeReader().NbRootsForTransfer() == 0)
    throw Refusal("holds no shape", "export the assembly, not only its structure");
  Handle(TDocStd_Document) xde = new TDocStd_Document("tandem");
  XCAFDoc_DocumentTool::Set(xde->Main());
  const Handle(XSControl_WorkSession) session = reader.Reader().WS();
  const Interface_CheckIterator load = session->ModelCheckList(true);
  if (!reader.Transfer(xde))
    throw Refusal("holds no shape that OpenCASCADE can make", "export it again, as AP214 or AP242");
  Document document = Reader(xde->Main()).read();
  count_faults(load, document);
  count_faults(session->TransferReader()->LastCheckList(), document);
  document.unit = lengths.IsEmpty() ? "" : lengths.First().ToCString();
  if (document.products.empty()) throw Refusal("holds no shape", "export the parts with their solids");
  return document;
}

}  // namespace tandem::step
