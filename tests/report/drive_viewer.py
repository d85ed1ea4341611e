#!/usr/bin/python3
"""Opens a page of the viewer in Chromium, works on it by keys, clicks and drags, and prints what it saw as JSON.

Usage: drive_viewer.py PROFILE_FOLDER [whole|look|flat] PAGE...
whole: all actions; look: opens pages alone, prints a list; flat: the same without WebGL.
"""
import json
import sys

from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

profile, how, pages = sys.argv[1], sys.argv[2], sys.argv[3:]
page = pages[0]
options = webdriver.ChromeOptions()
options.binary_location = "/usr/bin/chromium"
for flag in ["--headless", "--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-component-update",
             "--window-size=1200,1000", "--user-data-dir=" + profile]:
    options.add_argument(flag)
if how == "flat":
    options.add_argument("--disable-3d-apis")
else:
    for flag in ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]:
        options.add_argument(flag)
options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
seen = {}


def data(name):
    return driver.find_element(By.ID, "viewer").get_attribute("data-" + name)


def until(condition):
    WebDriverWait(driver, 60, poll_frequency=0.05).until(lambda _: condition())


def status():
    return driver.find_element(By.CSS_SELECTOR, ".status").text


def body():
    """The body's element, which takes keys that no control takes."""
    driver.execute_script("document.activeElement.blur()")
    return driver.find_element(By.TAG_NAME, "body")


# Pixels of the canvas with a strong colour: a person.
PIXELS = """
theViewer.seek(theViewer.state.time);  // a drawing lasts until this script ends
const canvas = document.querySelector('.stage > canvas[tabindex]'), copy = document.createElement('canvas');
copy.width = canvas.width; copy.height = canvas.height;
const pen = copy.getContext('2d');
pen.drawImage(canvas, 0, 0);
const all = pen.getImageData(0, 0, copy.width, copy.height).data;
let coloured = 0;
for (let i = 0; i < all.length; i += 4)
  if (Math.max(all[i], all[i + 1], all[i + 2]) - Math.min(all[i], all[i + 1], all[i + 2]) > 60) ++coloured;
return coloured;
"""
# Controls without a name, and those that the tabulator does not reach.
NAMELESS = """
return [...document.querySelectorAll('.viewer button, .viewer select, .viewer input, .viewer canvas[tabindex]')].filter(control =>
  !(control.textContent.trim() && control.tagName === 'BUTTON') && !control.getAttribute('aria-label') && !control.closest('label')
  || control.tabIndex < 0).map(control => control.outerHTML.slice(0, 80));
"""



def look(file):
    driver.get("file://" + file)
    until(lambda: data("clip") is not None or status() != "")
    if how == "flat":
        until(lambda: data("clip") is not None)
    saw = {"status": status(), "stage": data("stage"), "clip": data("clip"), "rows": data("rows"), "title": driver.title}
    if saw["clip"] is not None:
        saw["coloured"] = driver.execute_script(PIXELS)
        saw["nameless"] = driver.execute_script(NAMELESS)
    return saw


try:
    if how != "whole":
        seen = [look(file) for file in pages]
    else:
        seen = look(page)
        body().send_keys(Keys.ARROW_RIGHT)
        seen["after_right"] = data("time")
        body().send_keys(Keys.ARROW_RIGHT, Keys.ARROW_LEFT, Keys.END)
        seen["after_end"] = data("time")
        body().send_keys(Keys.HOME, Keys.SPACE)
        until(lambda: float(data("time")) > 0.2)
        seen["playing"] = data("playing")
        body().send_keys(Keys.SPACE)
        seen["paused"] = data("playing")
        seen["hash"] = driver.execute_script("return location.hash")
        canvas = driver.find_element(By.CSS_SELECTOR, ".stage > canvas[tabindex]")
        before = driver.execute_script("return theViewer.camera.yaw")
        ActionChains(driver).move_to_element(canvas).click_and_hold().move_by_offset(100, 0).release().perform()
        seen["turned"] = driver.execute_script("return theViewer.camera.yaw") - before
        body().send_keys(Keys.SHIFT + Keys.ARROW_LEFT)
        seen["turned_by_keys"] = driver.execute_script("return theViewer.camera.yaw") - before - seen["turned"]
        driver.find_element(By.CSS_SELECTOR, "input[data-option=path]").send_keys(Keys.SPACE)
        seen["path_by_space"] = [driver.execute_script("return theViewer.state.path"), data("playing")]
        body().send_keys("1")
        seen["front"] = driver.execute_script("return theViewer.camera.yaw")
        chosen = driver.find_elements(By.CSS_SELECTOR, ".clips button")
        seen["listed"] = len(chosen)
        chosen[1].click()
        until(lambda: data("clip") == chosen[1].get_attribute("data-clip"))
        seen["second"] = data("clip")
        seen["second_time"] = data("time")
        ActionChains(driver).send_keys(Keys.SPACE).perform()
        seen["space_after_click"] = data("playing")
        ActionChains(driver).send_keys(Keys.SPACE).perform()
        layout = driver.find_elements(By.CSS_SELECTOR, "select[data-option=layout]")
        if layout:
            wide = "return theViewer.state.shown.map(entry => entry.base[0])"
            seen["beside"] = driver.execute_script(wide)
            body().send_keys("o")
            seen["over"] = driver.execute_script(wide)
            driver.find_element(By.CSS_SELECTOR, "input[data-source]").click()
            seen["hidden"] = driver.execute_script("return theViewer.state.hidden.size")
        dots = driver.find_elements(By.CSS_SELECTOR, ".map canvas")
        if dots:
            across = dots[0].size["width"] / 2
            ActionChains(driver).move_to_element_with_offset(dots[0], int(across) - 12, dots[0].size["height"] // 2 - 12).click().perform()
            until(lambda: data("clip") != seen["second"])
            seen["mapped"] = data("clip")
            driver.find_element(By.CSS_SELECTOR, ".near button").click()
            until(lambda: data("clip") != seen["mapped"])
            seen["nearest"] = data("clip")
            dots[0].send_keys(Keys.ARROW_RIGHT)
            until(lambda: data("clip") != seen["nearest"])
            seen["mapped_by_key"] = data("clip")
            driver.find_element(By.CSS_SELECTOR, ".found button").click()
            seen["found_time"] = data("time")
        search = driver.find_element(By.CSS_SELECTOR, "input[type=search]")
        search.send_keys("no such clip")
        seen["found"] = len(driver.find_elements(By.CSS_SELECTOR, ".clips button"))
        search.clear()
        search.send_keys("wave")
        seen["found_label"] = len(driver.find_elements(By.CSS_SELECTOR, ".clips button"))
        driver.get("file://" + page + "#clip=" + driver.execute_script("return encodeURIComponent(theViewer.state.group.first.id)") + "&t=0.5")
        driver.refresh()
        until(lambda: data("clip") is not None)
        seen["linked"], seen["linked_time"] = data("clip"), data("time")
        driver.get("file://" + page + "#clip=unknown")
        until(lambda: status() != "")
        seen["unknown"] = status()
        seen["console"] = [entry["message"] for entry in driver.get_log("browser") if entry["level"] in ("SEVERE", "ERROR")]
finally:
    driver.quit()
print(json.dumps(seen))
