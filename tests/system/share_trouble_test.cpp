#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/finger_body.hpp"
#include "tests/system/shared_page.hpp"

/// A page of `palpate share` that cannot be touched says why, and what to do.
namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct ShareTroubleTest : test::SharedPage {
  bool makePage() const { return test::SharedPage::makePage(test::FingerBody()); }
  /// The message of the page after opening; nothing else is visible.
  std::string sentenceOf(test::Browser& browser) const {
    browser.go(page());
    EXPECT_TRUE(browser.becomesTrue("document.body && document.body.dataset.state"));
    EXPECT_EQ(browser.valueOf("document.body.dataset.state"), "stopped");
    EXPECT_EQ(heightOf(browser, "numbers"), 0);
    EXPECT_EQ(heightOf(browser, "words"), 0);
    EXPECT_GT(heightOf(browser, "trouble"), 0);
    return troubleOf(browser);
  }
  static int heightOf(test::Browser& browser, const std::string& id) {
    return browser.valueOf("document.getElementById('" + id + "').offsetHeight");
  }
  void put(const std::string& text) const { std::ofstream(page(), std::ios::binary) << text; }
  /// Changes the organ in the page: `change` is a Python expression of its bytes `o`.
  void changeOrgan(const std::string& change) const {
    const test::CommandResult changed =
        test::runCommand("cd '" + directory.path().string() +
                         "' && python3 -c \"import re, zlib, base64; t = open('body.html').read(); "
                         "m = re.search('id=.organ-bytes.[^>]*>([^<]*)', t); "
                         "o = zlib.decompress(base64.b64decode(m[1])); o = " +
                         change +
                         "; n = base64.b64encode(zlib.compress(o)).decode(); "
                         "open('body.html', 'w').write(t[:m.start(1)] + n + t[m.end(1):])\"");
    ASSERT_EQ(changed.exit_code, 0) << changed.output;
  }
};

TEST_F(ShareTroubleTest, ExplainsAMissingWebGl) {
  if (!makePage()) return;
  test::Browser browser({"--disable-3d-apis"});
  EXPECT_THAT(sentenceOf(browser), HasSubstr("WebGL"));
}

TEST_F(ShareTroubleTest, ExplainsStoppedGraphicsUntilTheyReturn) {
  if (!makePage()) return;
  test::Browser browser;
  open(browser);
  browser.valueOf(
      "(palpate.graphics = palpate.page.gl.getExtension('WEBGL_lose_context')).loseContext()");
  ASSERT_TRUE(browser.becomesTrue("document.body.dataset.state === 'stopped'"));
  EXPECT_THAT(troubleOf(browser), HasSubstr("graphics"));
  browser.valueOf("palpate.graphics.restoreContext()");
  ASSERT_TRUE(browser.becomesTrue("document.body.dataset.state === 'ready'"));
  EXPECT_EQ(troubleOf(browser), "");
  EXPECT_GT(heightOf(browser, "numbers"), 0);
  // The organ is drawn, not only the background.
  EXPECT_TRUE(browser.becomesTrue(
      "(() => { const {gl, camera, canvas} = palpate.page, pixel = new Uint8Array(4);"
      "  palpate.page.picture.draw(camera, palpate.page.scene());"
      "  gl.readPixels(canvas.width / 2, canvas.height / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE,"
      "                pixel);"
      "  return pixel[0] > pixel[2] + 20; })()"));
}

TEST_F(ShareTroubleTest, ExplainsItsOwnErrorsButNotThoseOfOtherScripts) {
  if (!makePage()) return;
  test::Browser browser;
  open(browser);
  browser.valueOf("dispatchEvent(new ErrorEvent('error', {message: 'x', filename: 'elsewhere'}))");
  EXPECT_EQ(browser.valueOf("document.body.dataset.state"), "ready");
  browser.valueOf("palpate.page.scene = () => nothing.like.it; palpate.page.changed = true");
  ASSERT_TRUE(browser.becomesTrue("document.body.dataset.state === 'stopped'"));
  EXPECT_THAT(troubleOf(browser), HasSubstr("nothing is not defined"));
}

TEST_F(ShareTroubleTest, ExplainsAMissingWebAssembly) {
  if (!makePage()) return;
  test::Browser browser;
  browser.runFirst("delete window.WebAssembly");
  EXPECT_THAT(sentenceOf(browser), HasSubstr("WebAssembly"));
}

TEST_F(ShareTroubleTest, ExplainsABrowserThatLacksAFunction) {
  if (!makePage()) return;
  test::Browser browser;
  browser.runFirst("delete window.DecompressionStream");
  EXPECT_THAT(sentenceOf(browser), HasSubstr("too old"));
}

TEST_F(ShareTroubleTest, ExplainsABrowserThatDoesNotKnowItsSyntax) {
  if (!makePage()) return;
  std::string code = bytesOf(page());
  const std::string known = "const byId = ";
  ASSERT_NE(code.find(known), std::string::npos);
  put(code.replace(code.find(known), 0, "const newer = known |?> unknown;\n"));
  test::Browser browser;
  EXPECT_THAT(sentenceOf(browser), HasSubstr("too old"));
}

TEST_F(ShareTroubleTest, ExplainsDisabledJavaScript) {
  if (!makePage()) return;
  test::Browser browser;
  browser.send("Emulation.setScriptExecutionDisabled", {{"value", true}});
  browser.go(page());
  ASSERT_TRUE(browser.becomesTrue("document.body && document.body.innerText.includes('settings')"));
  EXPECT_THAT(browser.valueOf("document.body.innerText").get<std::string>(),
              AllOf(HasSubstr("JavaScript"), Not(HasSubstr("Press depth"))));
}

TEST_F(ShareTroubleTest, ExplainsAnIncompleteFile) {
  if (!makePage()) return;
  const std::string whole = bytesOf(page());
  test::Browser browser;
  const auto expect = [&](const char* word) {
    EXPECT_THAT(sentenceOf(browser), HasSubstr(word));
    put(whole);
  };
  for (const std::size_t lost : {std::size_t{60}, std::size_t{3000}, whole.size() / 2}) {
    put(whole.substr(0, whole.size() - lost));
    expect("cut off");
  }
  changeOrgan("o[:len(o) // 2]");
  expect("cut off");
  const std::size_t organ = whole.find('>', whole.find("id=\"organ-bytes\"")) + 1;
  put(std::string(whole).replace(organ + 100, 4, whole[organ + 100] == 'A' ? "BBBB" : "AAAA"));
  expect("damaged");
  put(std::string(whole).replace(whole.find('{', whole.find("id=\"facts\"")), 1, "["));
  expect("damaged");
}

}  // namespace
}  // namespace palpate
