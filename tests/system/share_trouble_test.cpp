#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/finger_body.hpp"
#include "tests/system/shared_page.hpp"

/// A page of `palpate share` that cannot be touched: it says why, and what to do.
namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct ShareTroubleTest : test::SharedPage {
  bool makePage() const { return test::SharedPage::makePage(test::FingerBody()); }
  /// What the page says when it is opened, and that nothing else is seen.
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
  std::string sentence() const {
    test::Browser browser;
    return sentenceOf(browser);
  }
  std::string text() const {
    std::ifstream in(page(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put(const std::string& text) const { std::ofstream(page(), std::ios::binary) << text; }
  /// Another organ in the place of this one: `change` is Python of its bytes `o`.
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

TEST_F(ShareTroubleTest, WithoutWebGl) {
  if (!makePage()) return;
  test::Browser browser({"--disable-3d-apis"});
  EXPECT_THAT(sentenceOf(browser), AllOf(HasSubstr("WebGL"), HasSubstr("hardware acceleration")));
}

TEST_F(ShareTroubleTest, WhenGraphicsStopUntilTheyAreThereAgain) {
  if (!makePage()) return;
  test::Browser browser;
  open(browser);
  browser.valueOf(
      "(palpate.graphics = palpate.page.gl.getExtension('WEBGL_lose_context')).loseContext()");
  ASSERT_TRUE(browser.becomesTrue("document.body.dataset.state === 'stopped'"));
  EXPECT_THAT(troubleOf(browser), AllOf(HasSubstr("graphics"), HasSubstr("load the page again")));
  browser.valueOf("palpate.graphics.restoreContext()");
  ASSERT_TRUE(browser.becomesTrue("document.body.dataset.state === 'ready'"));
  EXPECT_EQ(troubleOf(browser), "");
  EXPECT_GT(heightOf(browser, "numbers"), 0);
  // The organ is drawn, not the background alone.
  EXPECT_TRUE(browser.becomesTrue(
      "(() => { const {gl, camera, canvas} = palpate.page, pixel = new Uint8Array(4);"
      "  palpate.page.picture.draw(camera, palpate.page.scene());"
      "  gl.readPixels(canvas.width / 2, canvas.height / 2, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE,"
      "                pixel);"
      "  return pixel[0] > pixel[2] + 20; })()"));
}

TEST_F(ShareTroubleTest, WhenItBreaksButNotWhenAScriptOfOthersDoes) {
  if (!makePage()) return;
  test::Browser browser;
  open(browser);
  browser.valueOf("dispatchEvent(new ErrorEvent('error', {message: 'x', filename: 'elsewhere'}))");
  EXPECT_EQ(browser.valueOf("document.body.dataset.state"), "ready");
  browser.valueOf("palpate.page.scene = () => nothing.like.it; palpate.page.changed = true");
  ASSERT_TRUE(browser.becomesTrue("document.body.dataset.state === 'stopped'"));
  EXPECT_THAT(troubleOf(browser),
              AllOf(HasSubstr("nothing is not defined"), HasSubstr("oad it again")));
}

TEST_F(ShareTroubleTest, WithoutWebAssembly) {
  if (!makePage()) return;
  test::Browser browser;
  browser.runFirst("delete window.WebAssembly");
  EXPECT_THAT(sentenceOf(browser), AllOf(HasSubstr("WebAssembly"), HasSubstr("another browser")));
}

TEST_F(ShareTroubleTest, InABrowserThatLacksWhatItCalls) {
  if (!makePage()) return;
  test::Browser browser;
  browser.runFirst("delete window.DecompressionStream");
  EXPECT_THAT(sentenceOf(browser), AllOf(HasSubstr("too old"), HasSubstr("Firefox 113")));
}

TEST_F(ShareTroubleTest, InABrowserThatDoesNotKnowItsSyntax) {
  if (!makePage()) return;
  std::string page = text();
  const std::string known = "const byId = ";
  ASSERT_NE(page.find(known), std::string::npos);
  put(page.replace(page.find(known), 0, "const newer = known |?> unknown;\n"));
  EXPECT_THAT(sentence(), AllOf(HasSubstr("too old"), HasSubstr("Firefox 113")));
}

TEST_F(ShareTroubleTest, WithoutJavaScript) {
  if (!makePage()) return;
  test::Browser browser;
  browser.send("Emulation.setScriptExecutionDisabled", {{"value", true}});
  browser.go(page());
  ASSERT_TRUE(browser.becomesTrue("document.body && document.body.innerText.includes('settings')"));
  EXPECT_THAT(browser.valueOf("document.body.innerText").get<std::string>(),
              AllOf(HasSubstr("needs JavaScript"), HasSubstr("save the file"),
                    Not(HasSubstr("Getting ready")), Not(HasSubstr("Press depth"))));
}

TEST_F(ShareTroubleTest, WhenItWasCutOff) {
  if (!makePage()) return;
  const std::string whole = text();
  test::Browser browser;
  for (const std::size_t lost : {std::size_t{60}, std::size_t{3000}, whole.size() / 2}) {
    put(whole.substr(0, whole.size() - lost));
    EXPECT_THAT(sentenceOf(browser), AllOf(HasSubstr("cut off"), HasSubstr("get the file again")))
        << lost;
  }
}

TEST_F(ShareTroubleTest, WithAnOrganOfAnotherVersion) {
  if (!makePage()) return;
  changeOrgan("o.replace(b'palpate-organ-3', b'palpate-organ-0', 1)");
  EXPECT_THAT(sentence(), AllOf(HasSubstr("version 0"), HasSubstr("of version 3"),
                                HasSubstr("make its page again with palpate share")));
}

TEST_F(ShareTroubleTest, WithADamagedOrgan) {
  if (!makePage()) return;
  changeOrgan("b'something else'");
  EXPECT_THAT(sentence(), AllOf(HasSubstr("no organ"), HasSubstr("palpate share")));
  makePage();
  changeOrgan("o[:len(o) // 2]");
  EXPECT_THAT(sentence(), AllOf(HasSubstr("cut off"), HasSubstr("palpate share")));
  makePage();
  // Behind version, name, its length, the largest force, and how many vertices there are.
  changeOrgan("(lambda at: o[:at] + b'\\xff' * 8 + o[at + 8:])(16 + 4 + o[16] + 8 + 4)");
  EXPECT_THAT(sentence(), AllOf(HasSubstr("vertex 0"), HasSubstr("palpate share")));
}

TEST_F(ShareTroubleTest, WithBytesThatCannotBeUnpacked) {
  if (!makePage()) return;
  std::string page = text();
  const std::size_t organ = page.find('>', page.find("id=\"organ-bytes\"")) + 1;
  put(page.replace(organ + 100, 4, page[organ + 100] == 'A' ? "BBBB" : "AAAA"));
  EXPECT_THAT(sentence(), AllOf(HasSubstr("damaged"), HasSubstr("get the file again")));
  makePage();
  page = text();
  put(page.replace(page.find('{', page.find("id=\"facts\"")), 1, "["));
  EXPECT_THAT(sentence(), AllOf(HasSubstr("damaged"), HasSubstr("get the file again")));
}

}  // namespace
}  // namespace palpate
