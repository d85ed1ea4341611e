#!/usr/bin/python3
"""Opens pages of `mocurate view` in headless Chromium with software WebGL and prints, for each: its size, the time from
opening it to the first picture, pictures a second while playing, and the memory of the tab after opening clips.

Usage: bench_viewer.py [--clips N] PAGE...   (needs chromium, chromium-driver, python3-selenium)
"""
import argparse
import os
import tempfile
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

parser = argparse.ArgumentParser()
parser.add_argument("--clips", type=int, default=60, help="clips to open, evenly spread")
parser.add_argument("pages", nargs="+")
arguments = parser.parse_args()


def resident(pid):
    """Resident memory of the largest renderer below a process, MB."""
    children = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8") as stat:
                parent = int(stat.read().rsplit(")", 1)[1].split()[1])
            children.setdefault(parent, []).append(int(name))
        except OSError:
            continue
    found, queue = [], [pid]
    while queue:
        process = queue.pop()
        queue += children.get(process, [])
        try:
            with open(f"/proc/{process}/cmdline", encoding="utf-8") as line, open(f"/proc/{process}/status", encoding="utf-8") as status:
                if "--type=renderer" in line.read():
                    found += [int(row.split()[1]) / 1024 for row in status if row.startswith("VmRSS")]
        except OSError:
            continue
    return max(found, default=float("nan"))


print("| page | MB | first picture, s | pictures a second | tab, MB | after clips |\n|---|---|---|---|---|---|")
for page in arguments.pages:
    with tempfile.TemporaryDirectory() as profile:
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for flag in ["--headless", "--no-sandbox", "--no-first-run", "--disable-background-networking", "--use-gl=angle",
                     "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--window-size=1200,1000", "--user-data-dir=" + profile]:
            options.add_argument(flag)
        service = Service("/usr/bin/chromedriver")
        driver = webdriver.Chrome(service=service, options=options)
        try:
            script = driver.execute_script
            driver.get("file://" + os.path.abspath(page))
            WebDriverWait(driver, 120).until(lambda _: script("return performance.getEntriesByName('first picture').length") > 0)
            first = script("return performance.getEntriesByName('first picture')[0].startTime") / 1000
            drawn = driver.execute_async_script("""
                const begin = performance.now(), done = arguments[0], play = () => document.querySelector('[data-do=play]').click();
                let count = 0;
                const next = now => { ++count; if (now - begin < 2000) requestAnimationFrame(next); else { play(); done(count / 2); } };
                play();
                requestAnimationFrame(next);""")
            ids = script("return [...document.querySelectorAll('.clips button')].map(b => b.dataset.clip)")
            chosen = ids[:: max(1, len(ids) // arguments.clips)]
            for clip in chosen:
                driver.execute_async_script("theViewer.select(arguments[0], 0).then(arguments[1])", clip)
            time.sleep(1)
            print(f"| {os.path.basename(page)} | {os.path.getsize(page) / 1e6:.1f} | {first:.2f} | {drawn:.0f} | "
                  f"{resident(service.process.pid):.0f} | {len(chosen)} |", flush=True)
        finally:
            driver.quit()
