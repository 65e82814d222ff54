(add-to-list 'auto-mode-alist '("\\.launch\\(\\.xml\\)?\\'" . nxml-mode))
(with-eval-after-load 'eglot (add-to-list 'eglot-server-programs '((nxml-mode yaml-mode yaml-ts-mode) . ("ur" "lsp"))))
(dolist (hook '(nxml-mode-hook yaml-mode-hook yaml-ts-mode-hook)) (add-hook hook #'eglot-ensure))
