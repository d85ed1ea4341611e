'use strict';
// Shared by the interactive pages: the browser's store, saving a file, and the page's keys.
const pageTools = {
  // The store is missing where the browser forbids it: reading gives null, keeping gives false.
  read(key) { try { return JSON.parse(localStorage.getItem(key)); } catch (e) { return null; } },
  keep(key, value) {
    try { localStorage.setItem(key, JSON.stringify(value)); } catch (e) { return false; }
    return true;
  },
  forget(key) { try { localStorage.removeItem(key); } catch (e) { /* nothing was kept */ } },
  save(text, type, name) {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], {type}));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  },
  // With a command key or alt; AltGr types brackets on many keyboards.
  hasCommand(e) { return (e.ctrlKey || e.metaKey || e.altKey) && !e.getModifierState('AltGraph'); },
  isTyping(e) {
    return /^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName) && !/^(range|checkbox)$/.test(e.target.type);
  },
};
