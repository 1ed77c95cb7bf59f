// tandem_step FILE FOLDER [DEVIATION]: reads a STEP file for `tandem import`, which limits its memory and
// time. Writes FOLDER/parts.json and one N.stl per product; where the file is refused, FOLDER/refusal.json
// with "problem" and "hint", and the exit status is 2. OpenCASCADE is linked here only.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Standard_Failure.hxx>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>

#include "launch/step/document.hpp"
#include "launch/step/refusal.hpp"
#include "launch/step/solids.hpp"

namespace {

using namespace tandem::step;
namespace fs = std::filesystem;

void write(const nlohmann::json& json, const fs::path& file) {
  // Names may hold bytes that are not UTF-8.
  std::ofstream(file) << json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

void read(const std::string& file, const fs::path& folder, std::optional<double> deviation) {
  const Document document = read_document(file);
  nlohmann::json parts{{"unit", document.unit},
                       {"faults", document.faults},
                       {"first_fault", document.first_fault},
                       {"tree", document.tree},
                       {"products", nlohmann::json::array()}};
  for (std::size_t i = 0; i < document.products.size(); ++i) {
    const Product& product = document.products[i];
    const auto about = [&](const std::string& problem) { return "part '" + product.name + "' " + problem; };
    try {
      parts["products"].push_back(
          facts_of_product(product.shape, deviation, folder / (std::to_string(i) + ".stl")));
    } catch (const Refusal& refusal) {
      throw Refusal(about(refusal.what()), refusal.hint);
    } catch (const Standard_Failure& failure) {
      throw Refusal(
          about(std::string("cannot be computed by OpenCASCADE (") + failure.GetMessageString() + ")"),
          "repair it in the CAD program, or leave it out");
    }
    parts["products"].back()["name"] = product.name;
  }
  write(parts, folder / "parts.json");
}

// A file may be made so that reading it takes all memory: it gets this much.
void limit_memory() {
#ifndef TANDEM_SANITIZED  // the address sanitizer reserves far more
  const rlimit most{std::uint64_t{8} << 30, std::uint64_t{8} << 30};
  setrlimit(RLIMIT_AS, &most);
#endif
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
}

}  // namespace

#ifdef TANDEM_SANITIZED
// OpenCASCADE keeps much of its data until the end of the process.
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0";
}
#endif

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: tandem_step FILE FOLDER [DEVIATION]   (tandem import starts it)\n");
    return 2;
  }
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody waits for the answer once tandem is gone
  limit_memory();
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  const fs::path folder = argv[2];
  const auto refuse = [&](const std::string& problem, const std::string& hint) {
    write({{"problem", problem}, {"hint", hint}}, folder / "refusal.json");
    return 2;
  };
  try {
    read(argv[1], folder, argc == 4 ? std::optional(std::strtod(argv[3], nullptr)) : std::nullopt);
    return 0;
  } catch (const Refusal& refusal) {
    return refuse(refusal.what(), refusal.hint);
  } catch (const Standard_Failure& failure) {
    return refuse(std::string("cannot be read by OpenCASCADE (") + failure.GetMessageString() + ")",
                  "export it again, as AP214 or AP242");
  } catch (const std::bad_alloc&) {
    return refuse("needs more memory than the import may take", "export fewer parts, or simpler ones");
  }
}
