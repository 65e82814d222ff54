(add-to-list 'auto-mode-alist '("\\.launch\\(\\.xml\\)?\\'" . nxml-mode))
(with-eval-after-load 'eglot (add-to-list 'eglot-server-programs '(nxml-mode . ("ur" "lsp"))))
(add-hook 'nxml-mode-hook #'eglot-ensure)
