// Python binding: documents of SDF, read by libsdformat.
#include <pybind11/functional.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <functional>
#include <iostream>
#include <sdf/sdf.hh>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace {

using Find = std::function<std::string(const std::string&)>;

/** Files are named relative to the one that names them: here by their whole path, as long as that is known. */
void locateFiles(const sdf::ElementPtr& element) {
  const std::string tag = element->GetName();
  const std::string file = element->FilePath();
  if ((tag == "uri" || tag == "filename") && element->GetValue() && !file.empty() && file[0] == '/') {
    const std::filesystem::path named = element->Get<std::string>();
    const std::filesystem::path path = std::filesystem::path(file).parent_path() / named;
    const bool relative = named.is_relative() && named.string().find("://") == std::string::npos;
    if (relative && std::filesystem::exists(path)) element->Set(path.lexically_normal().string());
  }
  for (sdf::ElementPtr child = element->GetFirstElement(); child; child = child->GetNextElement()) locateFiles(child);
}

/** What libsdformat had to say of one place. */
std::string shown(const sdf::Error& error) {
  std::string text = error.Message();
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  if (error.FilePath()) text += " (" + *error.FilePath();
  if (error.FilePath() && error.LineNumber()) text += ":" + std::to_string(*error.LineNumber());
  return error.FilePath() ? text + ")" : text;
}

/** Keeps std::cerr quiet for as long as it lives: libsdformat prints what it also returns, and tries whatever is no SDF
 *  as a URDF, of which urdfdom complains. */
class QuietErrors {
 public:
  QuietErrors() : before_(std::cerr.rdbuf(sink_.rdbuf())) {}
  ~QuietErrors() { std::cerr.rdbuf(before_); }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  std::ostringstream sink_;
  std::streambuf* before_;
};

/** An empty document. The specification is parsed once, which takes a quarter of a second. */
sdf::SDFPtr emptyDocument() {
  static const sdf::SDFPtr specification = [] {
    auto made = std::make_shared<sdf::SDF>();
    sdf::init(made);
    return made;
  }();
  auto document = std::make_shared<sdf::SDF>();
  document->Root(specification->Root()->Clone());
  return document;
}

/** Reads a document, brings it to the newest version and puts what is included in its place.
 *  @param source  a path, or the document itself @return its text, and a line for each thing that was left out
 *  @throws std::invalid_argument if it is no SDF, or libsdformat gives up */
std::pair<std::string, std::vector<std::string>> expanded(const std::string& source, bool is_path, const Find& find) {
  sdf::Console::Instance()->SetQuiet(true);  // what it would print comes back as a value
  const QuietErrors quiet;
  sdf::ParserConfig config;
  config.SetFindCallback(find);
  config.SetWarningsPolicy(sdf::EnforcementPolicy::ERR);
  config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
  config.SetDeprecatedElementsPolicy(sdf::EnforcementPolicy::LOG);
  const auto document = emptyDocument();
  sdf::Errors errors;
  bool read = false;
  try {
    read =
        is_path ? sdf::readFile(source, config, document, errors) : sdf::readString(source, config, document, errors);
  } catch (const py::error_already_set&) {
    throw;  // of find
  } catch (const std::exception& error) {
    throw std::invalid_argument(std::string("libsdformat gives up: ") + error.what());
  } catch (const sdf::Exception& error) {  // no std::exception
    throw std::invalid_argument("libsdformat gives up: " + error.GetErrorStr());
  }
  std::vector<std::string> messages;
  for (const sdf::Error& error : errors) messages.push_back(shown(error));
  if (!read) {
    std::string text = "no SDF";
    for (const std::string& message : messages) text += ": " + message;
    throw std::invalid_argument(text);
  }
  locateFiles(document->Root());
  return {document->Root()->ToString(""), messages};
}

}  // namespace

PYBIND11_MODULE(_sdf, module) {
  module.doc() = "Documents of SDF, read by libsdformat.";
  module.def(
      "expanded", &expanded, py::arg("source"), py::arg("is_path"), py::arg("find"),
      "The document (a path, or its text) in the newest version of SDF with what it includes, as text, and a list "
      "of lines that say what was left out. find(uri) is the path of what is included, \"\" if it is nowhere. "
      "Raises ValueError if it is no SDF.");
}
