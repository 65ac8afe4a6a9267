#pragma once
/// A page in a real browser: what a script says of it.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

namespace brink::testing {

inline bool has_browser() { return std::system("chromium --version >/dev/null 2>&1") == 0; }

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What chromium prints of a replay page once a script has written its answer (JSON) into it.
inline nlohmann::json in_browser(const std::filesystem::path& page, const std::string& script) {
  std::string text = text_of(page);
  const std::string asking =
      "<pre id=\"answer\"></pre><script>brink.ready.then(b => JSON.stringify((() => {" + script +
      "})())).catch(e => JSON.stringify({error: String(e.stack)}))"
      ".then(words => { const plain = words.replace(/[<>&]/g, c => '\\\\u00' + c.charCodeAt(0).toString(16));"
      " document.getElementById('answer').textContent = '@@' + plain + '@@'; });</script></body>";
  text.replace(text.rfind("</body>"), 7, asking);
  const std::filesystem::path asked = page.parent_path() / "asked.html";
  std::ofstream(asked) << text << std::flush;
  const std::string command =
      "timeout 120 chromium --headless=new --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader "
      "--user-data-dir=" +
      (page.parent_path() / "browser").string() + " --virtual-time-budget=20000 --dump-dom file://" +
      asked.string() + " 2>/dev/null";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::string dom;
  for (char buffer[4096]; const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe);)
    dom.append(buffer, n);
  ::pclose(pipe);
  const auto from = dom.find("answer\">@@"), to = dom.find("@@", from + 10);
  if (from == std::string::npos || to == std::string::npos)
    return {{"error", "no answer: " + dom.substr(0, 400)}};
  return nlohmann::json::parse(dom.substr(from + 10, to - from - 10));
}

}  // namespace brink::testing
