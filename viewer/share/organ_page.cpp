#include "viewer/share/organ_page.hpp"

#include <zlib.h>

#include <nlohmann/json.hpp>

#include "common/base/bytes32.hpp"
#include "common/base/error.hpp"
#include "common/base/markup.hpp"
#include "viewer/fields/relative_error.hpp"
#include "viewer/haptics/hand_pace.hpp"
#include "viewer/share/page_parts.hpp"

namespace palpate {
namespace {

std::string deflated(std::string_view bytes) {
  auto size = compressBound(bytes.size());
  std::string out(size, '\0');
  const int result =
      compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_COMPRESSION);
  if (result != Z_OK) throw failure("zlib could not compress the page (code {})", result);
  out.resize(size);
  return out;
}

std::string packedText(std::string_view bytes) { return base64Of(deflated(bytes)); }

nlohmann::json pageFacts(const CarriedOrgan& organ) {
  nlohmann::json facts = {{"name", organ.name},
                          {"maxForce", organ.max_force},
                          {"mostVertices", most_carried_vertices},
                          {"hand",
                           {{"pressRate", press_rate},
                            {"releaseRate", release_rate},
                            {"usualDepth", usual_depth},
                            {"usualShare", usual_share}}}};
  facts["error"] = {{"noticeable", noticeable_force_error}, {"floor", relative_error_floor}};
  for (const CarriedTouch& touch : organ.touches)
    facts["touches"].push_back({{"name", touch.name},
                                {"fingerRadius", touch.finger_radius},
                                {"sites", touch.spaces.size()}});
  return facts;
}

}  // namespace

bool hasPageField() { return !pageParts().field.empty(); }

void requirePageField() {
  if (!hasPageField())
    throw failure(
        "this palpate was built without Emscripten, which palpate share needs: install it "
        "(Debian: apt install emscripten) and rebuild palpate (docs/sharing.md)");
}

std::string organPage(const CarriedOrgan& organ) {
  requirePageField();
  const PageParts parts = pageParts();
  return filledMarkup(parts.markup, {{"name", escaped(organ.name)},
                                     {"style", std::string(parts.style)},
                                     {"trouble", std::string(parts.trouble)},
                                     {"script", std::string(parts.script)},
                                     {"worker", std::string(parts.worker)},
                                     {"facts", scriptJson(pageFacts(organ).dump(-1, ' ', true))},
                                     {"field", packedText(parts.field)},
                                     {"organ", packedText(encode(organ))}});
}

}  // namespace palpate
